// From states to colours: representatives, modes, what is between them, and what a body shows of it.

#include "offline/appearance/appearance_model.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "formats/testing/synthetic_motion.hpp"
#include "formats/write/aligned_bytes.hpp"
#include "offline/appearance/radial_basis.hpp"
#include "offline/appearance/shown_states.hpp"
#include "offline/appearance/state_clusters.hpp"
#include "offline/appearance/transfer_basis.hpp"
#include "runtime/impulse_response.hpp"

namespace greenloop::offline {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXf;

MatrixXd scattered(Index coordinates, Index points, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  return MatrixXd::NullaryExpr(coordinates, points, [&] { return uniform(random); });
}

TEST_CASE("each cluster of states has a representative, and it is one of them") {
  MatrixXd points(2, 300);
  const MatrixXd noise = scattered(2, 300, 1);
  for (Index i = 0; i < 300; ++i) points.col(i) = 0.1 * noise.col(i) + Eigen::Vector2d(i % 3, i % 3 == 2 ? 5 : 0);
  const auto chosen = representatives(points, 3, 7);
  REQUIRE(chosen.size() == 3);
  CHECK(std::is_sorted(chosen.begin(), chosen.end()));
  Index kinds = 0;
  for (const Index i : chosen) kinds += Index{1} << (i % 3);
  CHECK(kinds == 7);
  CHECK(representatives(points, 3, 7) == chosen);
  CHECK(representatives(points.leftCols(4), 9, 7).size() == 4);
}

TEST_CASE("between centres radial basis functions follow what is smooth") {
  const MatrixXd centres = scattered(2, 80, 3), points = 0.8 * scattered(2, 50, 4);
  const auto smooth = [](const Eigen::Vector2d& at) { return Eigen::Vector2d(std::sin(at[0]) + at[1], at[0] * at[1]); };
  MatrixXd values(2, centres.cols());
  for (Index k = 0; k < centres.cols(); ++k) values.col(k) = smooth(centres.col(k));
  const RadialBasis between(centres, values);
  double error = 0, size = 0;
  for (Index k = 0; k < points.cols(); ++k) {
    error += (between.at(points.col(k)) - smooth(points.col(k))).squaredNorm();
    size += smooth(points.col(k)).squaredNorm();
  }
  CHECK(std::sqrt(error / size) < 0.05);
  CHECK(between.at(Eigen::Vector2d(100, -50)).allFinite());
}

/// Transfers of 40 vertices with three modes about a mean, in all of them or with noise.
std::vector<VectorXf> three_modes(Index count, float noise) {
  const Index numbers = 48 * 40;
  const Eigen::MatrixXf modes = scattered(numbers, 3, 5).cast<float>();
  const Eigen::MatrixXf weights = scattered(3, count, 6).cast<float>();
  std::vector<VectorXf> transfers;
  for (Index k = 0; k < count; ++k) {
    VectorXf transfer = VectorXf::Constant(numbers, 0.4F) + 0.05F * modes * weights.col(k);
    transfer += noise * scattered(numbers, 1, 100 + static_cast<std::uint64_t>(k)).cast<float>();
    transfers.push_back(transfer);
  }
  return transfers;
}

TEST_CASE("transfers of three modes need three, and 8 bits keep them") {
  const auto transfers = three_modes(12, 0);
  std::vector<const VectorXf*> all;
  for (const auto& transfer : transfers) all.push_back(&transfer);
  const TransferBasis basis = transfer_basis(all, 10, 1e-3);
  REQUIRE(basis.modes.cols() == 3);
  CHECK((basis.modes.transpose() * basis.modes - Eigen::Matrix3f::Identity()).norm() < 1e-4F);
  for (std::size_t k = 0; k < all.size(); ++k) {
    const VectorXf again = basis.mean + basis.modes * basis.coordinates.col(static_cast<Index>(k)).cast<float>();
    CHECK((again - transfers[k]).norm() < 1e-3F * (transfers[k] - basis.mean).norm());
  }
  CHECK(basis.truncation(1) > basis.truncation(2));
  CHECK(basis.truncation(3) < 1e-3);
  CHECK(transfer_basis(all, 2, 1e-3).modes.cols() == 2);
  const AppearanceData data = quantised(basis, basis.coordinates);
  CHECK(data.amplitudes.size() == 3);
  CHECK(data.coordinates.size() == 3 * 12);
  CHECK(data.transfers.size() == 3 * 3 * layout::transfer_bytes(3));
  CHECK(data.quantisation_error > 0);
  CHECK(data.quantisation_error < 0.02F);
  const std::vector<const VectorXf*> alike = {all[0], all[0], all[0]};
  CHECK_THROWS_WITH(static_cast<void>(transfer_basis(alike, 3, 0.1)),
                    "appearance: light falls on all states alike; leave [appearance] out");
}

/// A strip whose waves hide and light one another.
ImpulseResponseData waving_strip() {
  ImpulseResponseData model = synthetic_motion({.vertices = 120, .orbits = 6});
  for (float& quantum : model.quanta) quantum *= 6;
  return model;
}

TEST_CASE("what a body shows is what rays say of the state that it is in") {
  ImpulseResponseData model = waving_strip();
  const std::vector<Eigen::Array3f> reflectance(120, Eigen::Array3f(0.9F, 0.5F, 0.3F));
  const AppearanceGoal goal{.transfer = {.rays = 64}, .error = 0.3, .rank = 12, .states = 48};
  std::uint32_t calls = 0;
  Appearance appearance = appearance_of(model, reflectance, goal, [&](auto, auto) { ++calls; });
  CHECK(calls >= appearance.data.states);
  REQUIRE(!appearance.sampling.empty());
  CHECK(appearance.data.states <= 48);
  CHECK(appearance.sampling.back().error < appearance.sampling.front().error + 1e-9);
  CHECK(appearance.noise > 0);
  CHECK(appearance.noise < 0.2);
  model.appearance = std::move(appearance.data);
  const ModelFile file = encoded_file(model);
  const Model opened = Model::open(file.bytes.span()).model;
  const auto need = ImpulseResponse::required(opened, {});
  AlignedBytes memory(need.bytes);
  // a step a row, so that states are rows
  auto created = ImpulseResponse::create(opened, {.rate = 128}, {memory.data(), memory.size()});
  REQUIRE(created);
  Light light;
  light.red[0] = light.green[0] = 3;
  light.red[2] = light.green[1] = light.blue[3] = 1;
  std::vector<Vec3> colour(120);
  const ShownStates states(model);
  double error = 0, size = 0, variation = 0;
  std::vector<Vec3> first;
  for (std::uint32_t i = 0; i < 60; ++i) {
    const std::uint32_t impulse = i == 0 ? 0 : ImpulseResponse::no_impulse;
    const auto report = created.body.step(impulse, {need.worst_work}, {.colour = colour, .light = &light});
    REQUIRE(report.status == Status::ok);
    if (i == 0) first = colour;
    if (i % 10 != 5 || report.blend > 1e-4F) continue;
    LitSurface surface{states.positions(report.row), {}, reflectance};
    for (std::size_t t = 0; t + 2 < model.triangles.size(); t += 3)
      surface.triangles.push_back({model.triangles[t], model.triangles[t + 1], model.triangles[t + 2]});
    const Eigen::MatrixXf transfer = radiance_transfer(surface, goal.transfer);
    for (Index v = 0; v < 120; ++v) {
      const float truth = transfer.col(v).head(16).dot(Eigen::Map<const Eigen::Vector<float, 16>>(light.red));
      const float found = colour[static_cast<std::size_t>(v)].x;
      error += std::pow(static_cast<double>(truth - found), 2);
      size += std::pow(static_cast<double>(truth), 2);
      variation += std::pow(static_cast<double>(truth - first[static_cast<std::size_t>(v)].x), 2);
    }
  }
  CHECK(size > 0);
  CHECK(error < 0.5 * variation);
  CHECK(std::sqrt(error / size) < 0.2);
}

}  // namespace
}  // namespace greenloop::offline
