// What bounds a body with cavities.
#include "offline/surface/shells.hpp"

#include <doctest/doctest.h>

#include <string>
#include <utility>

#include "offline/surface/area_and_volume.hpp"
#include "offline/surface/surface_preparation.hpp"
#include "offline/surface/test_surfaces.hpp"

namespace greenloop::offline {
namespace {

TriangleMesh scaled(TriangleMesh mesh, double factor, const Eigen::Vector3d& corner) {
  for (auto& vertex : mesh.vertices) vertex = corner + factor * vertex;
  return mesh;
}

TriangleMesh inverted(TriangleMesh mesh) {
  for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  return mesh;
}

/// A unit cube with two small cubes inside, one of which looks inwards as a drawing of a cavity should.
TriangleMesh hollow_cube() {
  const auto left = scaled(cube(), 0.2, {0.1, 0.4, 0.4}), right = inverted(scaled(cube(), 0.3, {0.6, 0.4, 0.4}));
  return joined(joined(left, cube()), right);
}

std::string refusal(const TriangleMesh& mesh) {
  try {
    static_cast<void>(split_shells(mesh));
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST_CASE("the skin is what encloses most, cavities follow by volume, each looks outwards by itself") {
  const Shells shells = split_shells(hollow_cube());
  CHECK(enclosed_volume(shells.skin) == doctest::Approx(1));
  REQUIRE(shells.cavities.size() == 2);
  CHECK(enclosed_volume(shells.cavities[0]) == doctest::Approx(0.027));
  CHECK(enclosed_volume(shells.cavities[1]) == doctest::Approx(0.008));
  CHECK(volume_of_all(shells.cavities) == doctest::Approx(0.035));
  const TriangleMesh walls = walls_of(shells.cavities);
  CHECK(walls.vertices.size() == 16);
  CHECK(enclosed_volume(walls) == doctest::Approx(-0.035));
}

TEST_CASE("walls are found again in the boundary of all") {
  const Shells shells = split_shells(hollow_cube());
  const TriangleMesh all = joined(shells.skin, walls_of(shells.cavities));
  const TriangleMesh walls = inward_pieces(all);
  CHECK(walls.vertices.size() == all.vertices.size());
  CHECK(walls.triangles.size() == 24);
  CHECK(walls.triangles.front()[0] >= 8);
}

TEST_CASE("what is no cavity is refused with its place") {
  CHECK(refusal(joined(scaled(cube(), 3, {0, 0, 0}), cube({4, 0, 0}))).find("12 faces at (4, 0, 0) is no cavity") !=
        std::string::npos);
  const auto nested =
      joined(joined(scaled(cube(), 3, {0, 0, 0}), cube({1, 1, 1})), scaled(cube(), 0.2, {1.4, 1.4, 1.4}));
  CHECK(refusal(nested).find("12 faces at (1.4, 1.4, 1.4) lies in a cavity") != std::string::npos);
  TriangleMesh many = scaled(cube(), 100, {-1, -1, -1});
  for (std::size_t i = 0; i <= most_cavities; ++i) {
    many = joined(many, scaled(cube(), 0.5, Eigen::Vector3d::Constant(static_cast<double>(i))));
  }
  CHECK(refusal(many).find("a body may have 64 cavities") != std::string::npos);
}

TEST_CASE("pieces inside are refused unless they are asked for, and other defects stay") {
  CHECK_THROWS_AS(static_cast<void>(prepare_surface(hollow_cube())), SurfaceError);
  const auto prepared = prepare_surface(soup(hollow_cube()), {}, Inside::cavities);
  CHECK(prepared.cavities.size() == 2);
  CHECK(prepared.report.volume == doctest::Approx(1));
  CHECK(prepared.report.component_sizes.size() == 1);
  TriangleMesh open = hollow_cube();
  open.triangles.pop_back();
  CHECK_THROWS_AS(static_cast<void>(prepare_surface(open, {}, Inside::cavities)), SurfaceError);
  const auto crossing = joined(cube(), cube({0.5, 0.5, 0.5}));
  CHECK_THROWS_AS(static_cast<void>(prepare_surface(crossing, {}, Inside::cavities)), SurfaceError);
}

}  // namespace
}  // namespace greenloop::offline
