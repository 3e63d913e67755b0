#include "offline/report/depth_buffer.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

namespace greenloop::offline {
namespace {

/// Two triangles that cover the left and the whole of a 10 x 10 picture, the small one at depth z.
std::vector<Eigen::Vector3f> small_before_large(float z) {
  return {{0, 0, z}, {6, 0, z}, {0, 6, z}, {-20, -20, 0}, {40, -20, 0}, {-20, 40, 0}};
}

}  // namespace

TEST_CASE("no place is beyond the picture, and what covers it again and again ends") {
  constexpr float huge = 1e30F;
  DepthBuffer buffer(8, 4);
  buffer.draw({{-huge, -huge, 0}, {huge, -huge, 0}, {0, huge, 0}, {0, 0, NAN}, {NAN, INFINITY, -INFINITY}},
              {{0, 3, 4}, {4, 4, 4}, {0, 1, 2}});
  const std::vector<Eigen::Vector3f> corners{{-200, -200, 0}, {400, -200, 0}, {0, 400, 0},
                                             {-200, -200, 9}, {400, -200, 9}, {0, 400, 9}};
  std::vector<std::array<int, 3>> often(2 * DepthBuffer::most_layers, {0, 1, 2});
  often.push_back({3, 4, 5});
  DepthBuffer covered(64, 64);
  covered.draw(corners, often);
  CHECK(covered.triangle(0, 0) == 0);  // the nearer one came too late
}

TEST_CASE("the nearer triangle hides the farther one, whatever the order") {
  for (const bool near_first : {false, true}) {
    CAPTURE(near_first);
    DepthBuffer buffer(10, 10);
    const std::vector<std::array<int, 3>> both{{0, 1, 2}, {3, 4, 5}};
    const std::vector<std::array<int, 3>> swapped{{3, 4, 5}, {0, 1, 2}};
    buffer.draw(small_before_large(1), near_first ? both : swapped);
    CHECK(buffer.triangle(1, 1) == (near_first ? 0 : 1));
    CHECK(buffer.depth(1, 1) == doctest::Approx(1));
    CHECK(buffer.triangle(8, 8) == (near_first ? 1 : 0));
    CHECK(buffer.depth(8, 8) == doctest::Approx(0));
  }
}

TEST_CASE("a triangle behind stays hidden") {
  DepthBuffer buffer(10, 10);
  buffer.draw(small_before_large(-1), {{0, 1, 2}, {3, 4, 5}});
  CHECK(buffer.triangle(1, 1) == 1);
}

TEST_CASE("interpenetrating triangles are cut along their intersection") {
  DepthBuffer buffer(20, 20);
  const std::vector<Eigen::Vector3f> vertices{{-40, -40, -60}, {80, -40, 60},  {-40, 80, -60},
                                              {-40, -40, 40},  {80, -40, -80}, {-40, 80, 40}};
  buffer.draw(vertices, {{0, 1, 2}, {3, 4, 5}});
  CHECK(buffer.triangle(2, 10) == 1);  // z = x - 20 against z = -x: they cross at x = 10
  CHECK(buffer.triangle(17, 10) == 0);
}

TEST_CASE("neighbours leave no gap and outside is nothing") {
  DepthBuffer buffer(8, 8);
  buffer.draw({{0, 0, 0}, {8, 0, 0}, {8, 8, 0}, {0, 8, 0}}, {{0, 1, 2}, {0, 2, 3}});
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 8; ++x) CHECK(buffer.triangle(x, y) != DepthBuffer::nothing);
  }
  CHECK(buffer.triangle(-1, 0) == DepthBuffer::nothing);
  CHECK(buffer.triangle(8, 0) == DepthBuffer::nothing);
}

TEST_CASE("a triangle seen edge-on draws nothing") {
  DepthBuffer buffer(4, 4);
  buffer.draw({{0, 0, 0}, {4, 4, 0}, {2, 2, 5}}, {{0, 1, 2}});
  CHECK(buffer.triangle(2, 2) == DepthBuffer::nothing);
}

TEST_CASE("barycentric weights sum to one and single out the vertices") {
  const Eigen::Vector3f a(1, 1, 0), b(5, 2, 0), c(2, 6, 0);
  const Eigen::Vector3f inside = barycentric(a, b, c, 2.5F, 3);
  CHECK(inside.sum() == doctest::Approx(1));
  CHECK(barycentric(a, b, c, 5, 2).y() == doctest::Approx(1));
}

}  // namespace greenloop::offline
