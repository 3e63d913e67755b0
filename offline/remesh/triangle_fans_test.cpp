#include "offline/remesh/triangle_fans.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "offline/remesh/surface.hpp"

namespace greenloop::offline {
namespace {

// poles 0 and 1, the equator 2 3 4 5
TriangleFans octahedron() {
  return {{{0, 2, 3}, {0, 3, 4}, {0, 4, 5}, {0, 5, 2}, {1, 3, 2}, {1, 4, 3}, {1, 5, 4}, {1, 2, 5}}, 6};
}

// closed and oriented, or triangle_neighbors throws; every triangle stands in the fans of its corners, and nowhere else
void check(const TriangleFans& fans, std::size_t triangles) {
  std::vector<std::array<int, 3>> left;
  for (int t = 0; t < static_cast<int>(fans.triangles()); ++t) {
    if (!fans.has_triangle(t)) continue;
    left.push_back(fans.corners(t));
    for (const int v : fans.corners(t)) {
      CHECK(std::count(fans.around(v).begin(), fans.around(v).end(), t) == 1);
    }
  }
  CHECK(left.size() == triangles);
  CHECK_NOTHROW((void)triangle_neighbors(left));
}

TEST_CASE("fans know neighbours and sides") {
  const TriangleFans fans = octahedron();
  check(fans, 8);
  CHECK(fans.neighbors(2) == std::vector<int>{0, 1, 3, 5});
  CHECK(fans.common_neighbors(0, 1) == std::vector<int>{2, 3, 4, 5});
  CHECK(fans.sides(2, 3) == std::array<int, 2>{0, 4});
  CHECK(fans.sides(3, 2) == std::array<int, 2>{4, 0});
  CHECK(fans.sides(0, 1) == std::array<int, 2>{-1, -1});
  CHECK(fans.following(0, 3) == 0);
}

TEST_CASE("a surface stays closed when edges are split, flip and collapse") {
  TriangleFans fans = octahedron();
  const int middle = fans.split(2, 3);
  CHECK(middle == 6);
  check(fans, 10);
  CHECK(fans.neighbors(middle) == std::vector<int>{0, 1, 2, 3});
  CHECK(fans.common_neighbors(2, 3) == std::vector<int>{0, 1, 6});

  fans.flip(middle, 0);
  check(fans, 10);
  CHECK(fans.valence(middle) == 3);
  CHECK(fans.sides(2, 3)[0] >= 0);

  fans.collapse(middle, 1);
  check(fans, 8);
  CHECK_FALSE(fans.has_vertex(middle));
  CHECK(fans.neighbors(1) == std::vector<int>{2, 3, 4, 5});
}

}  // namespace
}  // namespace greenloop::offline
