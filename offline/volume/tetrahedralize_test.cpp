#include "offline/volume/tetrahedralize.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <iostream>
#include <numbers>
#include <sstream>
#include <stdexcept>

#include "offline/surface/area_and_volume.hpp"
#include "offline/volume/boundary_interpolation.hpp"
#include "offline/volume/testing/shapes.hpp"
#include "offline/volume/tetgen_mesher.hpp"

namespace greenloop::offline {
namespace {

using testing::ellipsoid;
using testing::torus;

TEST_CASE("tetrahedra fill an ellipsoid, keep its vertices first and add interior nodes") {
  const auto surface = finest_surface(ellipsoid(3, {0.1, 0.07, 0.05}));
  const auto filled = tetrahedralize(surface);
  CHECK(filled.mesher == "netgen");
  REQUIRE_NOTHROW(require_fills_surface(filled.mesh, surface));
  CHECK(filled.quality.inverted == 0);
  CHECK(filled.quality.slivers == 0);
  CHECK(filled.quality.min_quality > 0.2);
  CHECK(filled.quality.interior_nodes == filled.mesh.vertices.size() - surface.vertices.size());
  CHECK(filled.quality.interior_nodes > surface.vertices.size() / 4);
  // 3 % below the smooth ellipsoid's at most, since the vertices lie on it
  const double smooth = 4.0 / 3.0 * std::numbers::pi * 0.1 * 0.07 * 0.05;
  CHECK(filled.quality.volume < smooth);
  CHECK(filled.quality.volume > 0.97 * smooth);
}

TEST_CASE("elements grow inwards as far as asked") {
  const auto surface = finest_surface(ellipsoid(3, {1, 0.9, 0.8}));
  const auto uniform = tetrahedralize(surface, {.interior_growth = 1.0, .optimization_steps = 1});
  const auto growing = tetrahedralize(surface, {.interior_growth = 4.0, .optimization_steps = 1});
  CHECK(growing.quality.interior_nodes > surface.vertices.size() / 5);
  CHECK(growing.quality.interior_nodes < uniform.quality.interior_nodes);
}

TEST_CASE("a torus is filled at any scale and place") {
  auto surface = torus(2.0, 0.7, 20, 8);
  for (const double scale : {1e-3, 1e3}) {
    auto moved = surface;
    for (auto& x : moved.vertices) x = scale * (x + Eigen::Vector3d(5, -3, 2));
    const auto filled = tetrahedralize(moved);
    CHECK(filled.quality.slivers == 0);
    CHECK(filled.quality.interior_nodes > 0);
    CHECK(filled.quality.volume == doctest::Approx(enclosed_volume(moved)).epsilon(1e-9));
  }
}

TEST_CASE("the same surface gives the same bits, and nothing is printed") {
  std::ostringstream printed;
  auto* const before = std::cout.rdbuf(printed.rdbuf());
  const auto surface = finest_surface(ellipsoid(2, {1, 0.9, 0.8}));
  const auto first = tetrahedralize(surface), second = tetrahedralize(surface);
  std::cout.rdbuf(before);
  CHECK(printed.str().empty());
  CHECK(first.mesh.vertices == second.mesh.vertices);
  CHECK(first.mesh.tetrahedra == second.mesh.tetrahedra);
}

TEST_CASE("surfaces that enclose no volume are refused with the reason") {
  const auto surface = torus(2.0, 0.7, 24, 10);
  auto open = surface;
  open.triangles.pop_back();
  CHECK_THROWS_WITH_AS((void)tetrahedralize(open), doctest::Contains("open at edge"), std::invalid_argument);
  auto inward = surface;
  for (auto& t : inward.triangles) std::swap(t[1], t[2]);
  CHECK_THROWS_WITH_AS((void)tetrahedralize(inward), doctest::Contains("reverse"), std::invalid_argument);
  auto stray = surface;
  stray.vertices.emplace_back(9, 9, 9);
  CHECK_THROWS_WITH_AS((void)tetrahedralize(stray), doctest::Contains("belongs to no triangle"), std::invalid_argument);
  CHECK_THROWS_WITH_AS((void)tetrahedralize(surface, {.grading = 3.0}), doctest::Contains("grading"),
                       std::invalid_argument);
}

TEST_CASE("a surface that crosses itself is refused with two triangles that do") {
  auto crossing = finest_surface(ellipsoid(2, {1, 1, 1}));
  crossing.vertices[20] *= -1.5;
  CHECK_THROWS_WITH_AS((void)tetrahedralize(crossing), doctest::Contains("intersects itself"), std::invalid_argument);
  auto overlapping = torus(1.0, 0.3, 14, 6);
  const auto other = overlapping;
  const int first = static_cast<int>(other.vertices.size());
  for (const auto& x : other.vertices) overlapping.vertices.emplace_back(x + Eigen::Vector3d(0.55, 0.05, 0.11));
  for (const auto& t : other.triangles) overlapping.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  CHECK_THROWS_WITH_AS((void)tetrahedralize(overlapping), doctest::Contains("intersects itself"),
                       std::invalid_argument);
}

TEST_CASE("flat sides and right angles are filled") {
  const auto surface = extract_boundary(testing::box({4, 3, 2}, {4, 3, 2})).surface;
  const auto filled = tetrahedralize(surface);
  CHECK(filled.quality.volume == doctest::Approx(24.0));
  CHECK(filled.quality.slivers == 0);
}

TEST_CASE("the check of a filled surface sees what is wrong") {
  const auto surface = finest_surface(ellipsoid(2, {1, 0.9, 0.8}));
  const auto good = tetrahedralize(surface).mesh;
  auto moved = good;
  moved.vertices[7].x() += 1e-12;
  CHECK_THROWS_WITH(require_fills_surface(moved, surface), doctest::Contains("vertex 7 was moved"));
  auto missing = good;
  missing.tetrahedra.pop_back();
  CHECK_THROWS_AS(require_fills_surface(missing, surface), std::runtime_error);
  auto inverted = good;
  std::swap(inverted.tetrahedra[5][0], inverted.tetrahedra[5][1]);
  CHECK_THROWS_WITH(require_fills_surface(inverted, surface), doctest::Contains("tetrahedron 5"));
}

TEST_CASE("TetGen as a separate program fills the same surface, or its absence is said") {
  const auto surface = torus(2.0, 0.7, 36, 14);
  if (!tetgen_is_installed()) {
    CHECK_THROWS_WITH_AS((void)mesh_with_tetgen(surface), doctest::Contains("cannot start"), std::runtime_error);
    return;
  }
  const auto mesh = mesh_with_tetgen(surface);
  CHECK_NOTHROW(require_fills_surface(mesh, surface));
  CHECK(measure_quality(mesh).interior_nodes > 0);
}

}  // namespace
}  // namespace greenloop::offline
