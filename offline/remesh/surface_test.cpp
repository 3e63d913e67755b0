#include "offline/remesh/surface.hpp"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace greenloop::offline {
namespace {

TriangleMesh unit_cube() {
  TriangleMesh mesh;
  for (int k = 0; k < 8; ++k) mesh.vertices.emplace_back(k & 1, (k >> 1) & 1, (k >> 2) & 1);
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

}  // namespace

TEST_CASE("walking around a cube comes back to the start") {
  const Surface cube(unit_cube());
  const SurfacePoint start{2, Eigen::Vector3d(0.5, 0.2, 0.3)};  // on top
  const auto once_around = cube.walk(start, Eigen::Vector3d(4, 0, 0));
  CHECK((cube.position(once_around) - cube.position(start)).norm() < 1e-12);
  CHECK(once_around.triangle == start.triangle);
}

TEST_CASE("a walk over an edge unfolds it") {
  const Surface cube(unit_cube());
  const SurfacePoint start{2, Eigen::Vector3d(0.25, 0.5, 0.25)};  // top, at (0.75, 0.25, 1)
  const auto end = cube.position(cube.walk(start, Eigen::Vector3d(0.5, 0, 0)));
  CHECK((end - Eigen::Vector3d(1, 0.25, 0.75)).norm() < 1e-12);
}

TEST_CASE("a displacement is laid into the surface with its length kept") {
  const Surface cube(unit_cube());
  const SurfacePoint start{2, Eigen::Vector3d(0.25, 0.5, 0.25)};
  const auto end = cube.position(cube.walk(start, Eigen::Vector3d(-0.12, 0, 0.16)));
  CHECK((end - Eigen::Vector3d(0.55, 0.25, 1)).norm() < 1e-12);
}

TEST_CASE("normals point outwards and blend over the corners") {
  const Surface cube(unit_cube());
  const Eigen::Vector3d at_corner = cube.normal({2, Eigen::Vector3d(0, 0, 1)});  // vertex 7 = (1, 1, 1)
  CHECK((at_corner - Eigen::Vector3d::Constant(1 / std::sqrt(3.0))).norm() < 1e-12);
}

TEST_CASE("an open surface is refused") {
  auto open = unit_cube();
  open.triangles.pop_back();
  CHECK_THROWS_AS(Surface{open}, std::invalid_argument);
}

}  // namespace greenloop::offline
