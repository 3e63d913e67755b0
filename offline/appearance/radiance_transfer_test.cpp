// Transfers against what is known of light on planes, beside walls, in furnaces, and of turned scenes.

#include "offline/appearance/radiance_transfer.hpp"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "runtime/light.hpp"

namespace greenloop::offline {
namespace {

using Eigen::Array3f;
using Eigen::Index;
using Eigen::Vector3f;

/// Adds a grid of side x side cells: from `corner` along `right` and `up`, lit from right x up.
void add_sheet(const Vector3f& corner, const Vector3f& right, const Vector3f& up, std::uint32_t side,
               const Array3f& reflectance, LitSurface& surface) {
  const auto first = static_cast<std::uint32_t>(surface.positions.size());
  for (std::uint32_t j = 0; j <= side; ++j) {
    for (std::uint32_t i = 0; i <= side; ++i) {
      const auto n = static_cast<float>(side);
      surface.positions.emplace_back(corner + static_cast<float>(i) / n * right + static_cast<float>(j) / n * up);
      surface.reflectance.push_back(reflectance);
    }
  }
  for (std::uint32_t j = 0; j < side; ++j) {
    for (std::uint32_t i = 0; i < side; ++i) {
      const std::uint32_t a = first + j * (side + 1) + i, d = a + side + 1;
      surface.triangles.push_back({a, a + 1, d + 1});
      surface.triangles.push_back({a, d + 1, d});
    }
  }
}

/// Exit radiance of each vertex in white light of radiance 1 from everywhere, [3][vertices].
Eigen::Array3Xf in_even_light(const Eigen::MatrixXf& transfer) {
  const auto light = std::sqrt(4 * std::numbers::pi_v<float>);
  Eigen::Array3Xf radiance(3, transfer.cols());
  for (Index c = 0; c < 3; ++c) radiance.row(c) = light * transfer.row(16 * c).array();
  return radiance;
}

LitSurface plane(const Array3f& reflectance) {
  LitSurface surface;
  add_sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 4, reflectance, surface);
  return surface;
}

TEST_CASE("an open plane: its reflectance in even light, and the cosine lobe's harmonics in any other") {
  const Array3f reflectance(0.8F, 0.5F, 0.2F);
  const auto transfer = radiance_transfer(plane(reflectance), {.rays = 256});
  CHECK((in_even_light(transfer).colwise() - reflectance).abs().maxCoeff() < 1e-4F);
  // clamped cosine over pi, by degree (Ramamoorthi & Hanrahan 2001)
  constexpr float lobe[] = {1, 2.0F / 3, 0.25F, 0};
  float up[16];
  light_harmonics({0, 0, 1}, up);
  for (Index i = 0; i < 16; ++i) {
    const auto degree = static_cast<std::size_t>(std::sqrt(static_cast<double>(i)));
    for (Index c = 0; c < 3; ++c) {
      const float exact = reflectance[c] * lobe[degree] * up[i];
      CHECK((transfer.row(16 * c + i).array() - exact).abs().maxCoeff() < 1e-4F);
    }
  }
}

TEST_CASE("beside a black wall the sky that it hides is missing") {
  constexpr float height = 1, distance = 0.5F, far = 200;
  LitSurface surface;
  add_sheet({distance - 0.1F, -0.1F, 0}, {0.2F, 0, 0}, {0, 0.2F, 0}, 2, Array3f::Constant(0.5F), surface);
  add_sheet({0, -far, 0}, {0, 2 * far, 0}, {0, 0, height}, 1, Array3f::Zero(), surface);
  const auto radiance = in_even_light(radiance_transfer(surface, {.rays = 16384}));
  // a point before an endless wall: half of 1 - cos of the angle under which it stands
  for (Index v = 0; v < 9; ++v) {
    const float x = surface.positions[static_cast<std::size_t>(v)].x();
    const float hidden = (1 - x / std::hypot(x, height)) / 2;
    CHECK(radiance(0, v) == doctest::Approx(0.5F * (1 - hidden)).epsilon(0.005));
  }
}

TEST_CASE("a white wall gives its colour to the floor beside it") {
  LitSurface surface;
  add_sheet({0, -1, 0}, {1, 0, 0}, {0, 2, 0}, 8, Array3f::Constant(0.5F), surface);
  add_sheet({0, -1, 0}, {0, 2, 0}, {0, 0, 1}, 8, Array3f(0.9F, 0.1F, 0.1F), surface);
  const TransferGoal goal{.rays = 1024};
  const auto all = in_even_light(radiance_transfer(surface, goal));
  const auto direct = in_even_light(radiance_transfer(surface, {.rays = 1024, .bounces = 0}));
  const Index beside = 4 * 9 + 1;  // of the floor
  CHECK(direct(0, beside) == doctest::Approx(direct(1, beside)));
  CHECK(all(0, beside) > 1.2F * all(1, beside));
  CHECK(all(1, beside) > direct(1, beside));
}

TEST_CASE("a white furnace: what reflects all light is as bright everywhere as the sky, however deep") {
  LitSurface box;  // open above
  const Array3f white = Array3f::Ones();
  add_sheet({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 4, white, box);
  add_sheet({0, 0, 0}, {0, 1, 0}, {0, 0, 1}, 4, white, box);
  add_sheet({1, 0, 0}, {0, 0, 1}, {0, 1, 0}, 4, white, box);
  add_sheet({0, 0, 0}, {0, 0, 1}, {1, 0, 0}, 4, white, box);
  add_sheet({0, 1, 0}, {1, 0, 0}, {0, 0, 1}, 4, white, box);
  const auto radiance = in_even_light(radiance_transfer(box, {.rays = 256, .change = 1e-6}));
  const auto direct = in_even_light(radiance_transfer(box, {.rays = 256, .bounces = 0}));
  const Index floor_middle = 12;
  CHECK(direct(0, floor_middle) < 0.5F);
  CHECK((radiance - 1).abs().maxCoeff() < 1e-3F);
}

TEST_CASE("light that turns with the scene changes nothing") {
  LitSurface surface;
  add_sheet({0, -1, 0}, {1, 0, 0}, {0, 2, 0}, 6, Array3f::Constant(0.6F), surface);
  add_sheet({0, -1, 0}, {0, 2, 0}, {0.2F, 0, 0.7F}, 6, Array3f(0.9F, 0.3F, 0.1F), surface);
  LitSurface turned = surface;
  const Eigen::Matrix<float, 3, 3, Eigen::RowMajor> rotation =
      Eigen::AngleAxisf(1.1F, Vector3f(1, 2, -2).normalized()).toRotationMatrix();
  for (Vector3f& position : turned.positions) position = rotation * position;
  Light light;
  for (int i = 0; i < 16; ++i) light.red[i] = std::cos(1.7F * static_cast<float>(i));
  float matrix[9];
  std::copy_n(rotation.data(), 9, matrix);
  const Light turned_light = rotated(light, matrix);
  const auto red = [](const Eigen::MatrixXf& transfer, const Light& of) {
    return Eigen::VectorXf(transfer.topRows(16).transpose() * Eigen::Map<const Eigen::Vector<float, 16>>(of.red));
  };
  const Eigen::VectorXf here = red(radiance_transfer(surface, {}), light);
  const Eigen::VectorXf there = red(radiance_transfer(turned, {}), turned_light);
  CHECK((here - there).norm() < 0.01F * here.norm());
  CHECK((red(radiance_transfer(turned, {}), light) - here).norm() > 0.1F * here.norm());
}

}  // namespace
}  // namespace greenloop::offline
