#include <doctest/doctest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "offline/compress/model_builder.hpp"
#include "offline/compress/testing/dense_compliance.hpp"
#include "runtime/elastostatic.hpp"

namespace greenloop::offline {
namespace {

constexpr std::size_t contact_count = 64;

struct Patch {
  std::vector<std::size_t> nodes;
  std::vector<Eigen::Index> unknowns;  // of the nodes in the compliance
};

// the free nodes nearest to one of them
Patch patch_around(const test::Body& body, std::size_t seed) {
  const Eigen::Vector3d centre = body.mesh.positions[body.column_nodes[seed]];
  std::vector<std::pair<double, std::size_t>> nearest;
  nearest.reserve(body.column_nodes.size());
  for (std::size_t j = 0; j < body.column_nodes.size(); ++j) {
    nearest.emplace_back((body.mesh.positions[body.column_nodes[j]] - centre).squaredNorm(), j);
  }
  std::sort(nearest.begin(), nearest.end());
  Patch patch;
  for (std::size_t i = 0; i < contact_count; ++i) {
    patch.nodes.push_back(body.column_nodes[nearest[i].second]);
    for (std::size_t k = 0; k < 3; ++k) {
      patch.unknowns.push_back(static_cast<Eigen::Index>(3 * nearest[i].second + k));
    }
  }
  return patch;
}

TEST_CASE("the loop's forces and fields from a built model are the exact compliance's, within the errors reported") {
  const auto body = test::make_body(3);
  const Accuracy accuracy{.rms = 0.01, .worst_column = 0.03, .patch_force = 0.05};
  const auto built = build_model({body.mesh,
                                  body.flags,
                                  body.area,
                                  body.column_nodes,
                                  test::columns_of(body.compliance),
                                  accuracy,
                                  layout::Wavelet::lifted_linear,
                                  test::facts(),
                                  "{}",
                                  {}},
                                 {});
  const AlignedBytes file(encode(built.model));
  const auto opened = Model::open(file.span());
  REQUIRE(opened);
  const Elastostatic::Limits limits{.max_contacts = contact_count, .cached_factors = 2};
  const auto need = Elastostatic::required(opened.model, limits);
  AlignedBytes memory(need.bytes);
  auto created = Elastostatic::create(opened.model, limits, {memory.data(), memory.size()});
  REQUIRE(created);

  const std::size_t nodes = body.mesh.positions.size();
  std::vector<float> force(3 * contact_count);
  AlignedBytes field_bytes(4 * sizeof(float) * nodes);
  auto* field = reinterpret_cast<float*>(field_bytes.data());
  double worst_force = 0;
  for (const std::size_t seed : {std::size_t{0}, std::size_t{40}, std::size_t{200}, std::size_t{430}}) {
    const auto patch = patch_around(body, seed);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      CAPTURE(seed);
      CAPTURE(axis);
      std::vector<Constraint> contacts;
      for (const std::size_t node : patch.nodes) {
        contacts.push_back({static_cast<std::uint32_t>(node), {}});
        contacts.back().value[axis] = 1e-3F;
      }
      const auto report = created.body.step(contacts, {.work = std::numeric_limits<std::uint64_t>::max()},
                                            {as_vec3(force), as_vec4({field, 4 * nodes})});
      REQUIRE(report.status == Status::ok);
      CHECK(report.constraint_level == 3);

      Eigen::VectorXd held = Eigen::VectorXd::Zero(3 * contact_count);
      for (std::size_t i = 0; i < contact_count; ++i) held(static_cast<Eigen::Index>(3 * i + axis)) = 1e-3;
      const Eigen::VectorXd exact = body.compliance(patch.unknowns, patch.unknowns).eval().llt().solve(held);
      const Eigen::VectorXd found = Eigen::Map<const Eigen::VectorXf>(force.data(), 3 * contact_count).cast<double>();
      const double error = (found - exact).norm() / exact.norm();
      CHECK(error <= accuracy.patch_force);
      worst_force = std::max(worst_force, error);

      const Eigen::VectorXd displaced = body.compliance(Eigen::all, patch.unknowns) * exact;
      double field_error = 0;
      for (std::size_t i = 0; i < body.column_nodes.size(); ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
          const auto u = static_cast<double>(field[4 * body.column_nodes[i] + k]);
          field_error = std::max(field_error, std::abs(u - displaced(static_cast<Eigen::Index>(3 * i + k))));
        }
      }
      CHECK(field_error < 0.03 * displaced.cwiseAbs().maxCoeff());
      for (std::size_t node = 0; node < nodes; ++node) {
        if ((body.flags[node] & layout::node_fixed) != 0) CHECK(field[4 * node + axis] == 0.0F);
      }
    }
  }
  CHECK(worst_force > 1e-4);  // there is something to measure
  CHECK(built.report.levels.back().patch_force_error <= accuracy.patch_force);
}

}  // namespace
}  // namespace greenloop::offline
