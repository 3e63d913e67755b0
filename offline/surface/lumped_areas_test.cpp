#include "offline/surface/lumped_areas.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <numeric>

#include "offline/surface/test_surfaces.hpp"

namespace greenloop::offline {
namespace {

TEST_CASE("lumped areas: a third of every triangle at each of its corners") {
  TriangleMesh corner;
  corner.vertices = {{0, 0, 0}, {3, 0, 0}, {0, 2, 0}, {0, 0, 4}};
  corner.triangles = {{0, 1, 2}, {0, 3, 1}};
  const auto areas = lumped_areas(corner);
  const std::vector<double> expected = {1.0 + 2.0, 1.0 + 2.0, 1.0, 2.0};
  REQUIRE(areas.size() == expected.size());
  for (std::size_t v = 0; v < areas.size(); ++v) CHECK(areas[v] == doctest::Approx(expected[v]));
}

TEST_CASE("lumped areas add up to the surface") {
  const auto areas = lumped_areas(cube());
  CHECK(std::accumulate(areas.begin(), areas.end(), 0.0) == doctest::Approx(6.0));
  CHECK(*std::min_element(areas.begin(), areas.end()) > 0.0);
}

}  // namespace
}  // namespace greenloop::offline
