#include "offline/simulate/embedding.hpp"

#include <doctest/doctest.h>

#include "offline/volume/testing/shapes.hpp"

namespace greenloop::offline {
namespace {

using Eigen::Vector3d;

TEST_CASE("points in a body, on it and a little off it go along with a linear displacement") {
  const auto mesh = testing::box({3, 2, 2}, {0.3, 0.2, 0.2});
  const std::vector<Vector3d> points{
      {0.11, 0.07, 0.13}, {0.3, 0.2, 0.2}, {0.15, 0.1, 0.2}, {0.31, 0.05, 0.1}, {-0.02, -0.02, 0.1}};
  const auto weights = embed(points, mesh);
  REQUIRE(weights.rows() == 5);
  Eigen::Matrix3d gradient;
  gradient << 0.3, -0.2, 0.5, 0.7, 0.1, -0.4, 0.2, 0.6, -0.8;
  Eigen::MatrixX3d displaced(mesh.vertices.size(), 3);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) displaced.row(v) = gradient * mesh.vertices[v];
  const Eigen::MatrixX3d shown = weights * displaced;
  for (std::size_t p = 0; p < points.size(); ++p) {
    CHECK((shown.row(p).transpose() - gradient * points[p]).norm() < 1e-14);
    double least = 1;
    for (Interpolation::InnerIterator it(weights, static_cast<int>(p)); it; ++it) least = std::min(least, it.value());
    CHECK(least > (p < 3 ? -1e-12 : -1.0));
  }
  CHECK_THROWS_AS(static_cast<void>(embed(points, {})), std::invalid_argument);
}

}  // namespace
}  // namespace greenloop::offline
