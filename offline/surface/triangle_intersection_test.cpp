#include "offline/surface/triangle_intersection.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include "offline/surface/box_tree.hpp"

using namespace greenloop;
using namespace greenloop::offline;
using Eigen::Vector3d;

namespace {

const Triangle flat{Vector3d(0, 0, 0), Vector3d(4, 0, 0), Vector3d(0, 4, 0)};

Triangle moved(const Triangle& t, const Vector3d& by) { return {t[0] + by, t[1] + by, t[2] + by}; }

std::vector<std::array<int, 2>> intersections(std::vector<Vector3d> vertices, std::vector<std::array<int, 3>> faces) {
  const TriangleMesh mesh{std::move(vertices), std::move(faces)};
  return self_intersections(mesh, std::vector<bool>(mesh.triangles.size(), false));
}

using Pairs = std::vector<std::array<int, 2>>;

}  // namespace

TEST_CASE("an edge through the middle") {
  CHECK(triangles_touch(flat, {Vector3d(1, 1, -1), Vector3d(1, 1, 1), Vector3d(9, 9, 0.5)}));
}

TEST_CASE("planes cross but triangles do not meet") {
  CHECK_FALSE(triangles_touch(flat, {Vector3d(3, 3, -1), Vector3d(3, 3, 1), Vector3d(9, 9, 0.5)}));
}

TEST_CASE("parallel triangles") { CHECK_FALSE(triangles_touch(flat, moved(flat, Vector3d(0, 0, 1e-300)))); }

TEST_CASE("coplanar triangles that overlap, contain each other, touch or lie apart") {
  CHECK(triangles_touch(flat, moved(flat, Vector3d(1, 1, 0))));
  CHECK(triangles_touch(flat, {Vector3d(1, 1, 0), Vector3d(1.5, 1, 0), Vector3d(1, 1.5, 0)}));
  CHECK(triangles_touch({Vector3d(1, 1, 0), Vector3d(1.5, 1, 0), Vector3d(1, 1.5, 0)}, flat));
  CHECK(triangles_touch(flat, moved(flat, Vector3d(4, 0, 0))));
  CHECK(triangles_touch(flat, moved(flat, Vector3d(2, 2, 0))));
  CHECK_FALSE(triangles_touch(flat, moved(flat, Vector3d(2.0001, 2, 0))));
}

TEST_CASE("a corner that touches a face from above") {
  CHECK(triangles_touch(flat, {Vector3d(1, 1, 0), Vector3d(1, 1, 1), Vector3d(2, 1, 1)}));
  CHECK_FALSE(triangles_touch(flat, {Vector3d(1, 1, 1e-18), Vector3d(1, 1, 1), Vector3d(2, 1, 1)}));
}

TEST_CASE("the answer depends on neither order nor numbering, seed 7") {
  std::mt19937_64 random(7);
  const auto coordinate = [&] { return static_cast<double>(random() % 5); };
  const auto point = [&] {
    const double x = coordinate(), y = coordinate(), z = coordinate();
    return Vector3d(x, y, z);
  };
  const auto flat_or_line = [](const Triangle& t) { return (t[1] - t[0]).cross(t[2] - t[0]).isZero(0); };
  int touching = 0;
  int wrong = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    Triangle s{point(), point(), point()};
    Triangle t{point(), point(), point()};
    if (flat_or_line(s) || flat_or_line(t)) {
      continue;
    }
    const bool expected = triangles_touch(s, t);
    touching += expected ? 1 : 0;
    wrong += triangles_touch(t, s) != expected ? 1 : 0;
    std::rotate(s.begin(), s.begin() + 1, s.end());
    std::swap(t[0], t[1]);
    wrong += triangles_touch(s, t) != expected ? 1 : 0;
  }
  CHECK(wrong == 0);
  CHECK(touching > 1000);
}

TEST_CASE("neighbours across an edge meet only if folded flat onto each other") {
  const std::vector<std::array<int, 3>> faces{{0, 1, 2}, {1, 0, 3}};
  const std::vector<Vector3d> edge_and_apex{{0, 0, 0}, {1, 0, 0}, {0.5, 1, 0}};
  const auto with = [&](const Vector3d& other) {
    auto vertices = edge_and_apex;
    vertices.push_back(other);
    return intersections(vertices, faces);
  };
  CHECK(with({0.5, -1, 0}).empty());
  CHECK(with({0.5, 1, 1e-9}).empty());
  CHECK(with({0.2, 0.5, 0}) == Pairs{{0, 1}});
}

TEST_CASE("neighbours in a vertex meet only if one reaches into the other") {
  const std::vector<std::array<int, 3>> faces{{0, 1, 2}, {0, 3, 4}};
  const auto with = [&](const Vector3d& c, const Vector3d& d) {
    return intersections({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, c, d}, faces);
  };
  CHECK(with({-1, 0, 1}, {-1, 0, -1}).empty());
  CHECK(with({-1, -1, 0}, {-1, -2, 0}).empty());
  CHECK(with({1, 1, 1}, {1, 1, -1}) == Pairs{{0, 1}});
  CHECK(with({1, 1, 0}, {1, 1, 1}) == Pairs{{0, 1}});
  CHECK(with({1, 1, 0}, {2, 1, 0}) == Pairs{{0, 1}});
}

TEST_CASE("vertices at the same position count as common") {
  CHECK(intersections({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 0}, {0, -1, 0}}, {{0, 1, 2}, {3, 4, 5}})
            .empty());
}

TEST_CASE("a face twice counts, unless skipped") {
  const TriangleMesh mesh{{flat.begin(), flat.end()}, {{0, 1, 2}, {2, 1, 0}}};
  CHECK(self_intersections(mesh, {false, false}) == Pairs{{0, 1}});
  CHECK(self_intersections(mesh, {false, true}).empty());
}

TEST_CASE("overlapping boxes are found once each, as by comparing all, seed 11") {
  std::mt19937_64 random(11);
  const auto unit = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  std::vector<Eigen::AlignedBox3d> boxes;
  for (int i = 0; i < 400; ++i) {
    const double x = unit(), y = unit(), z = unit(), size = 0.2 * unit();
    boxes.emplace_back(Vector3d(x, y, z), Vector3d(x, y, z) + Vector3d::Constant(size));
  }
  Pairs expected;
  for (int i = 0; i < 400; ++i) {
    for (int j = i + 1; j < 400; ++j) {
      if (boxes[i].intersects(boxes[j])) {
        expected.push_back({i, j});
      }
    }
  }
  Pairs found;
  for_each_overlap(boxes, [&](int i, int j) {
    found.push_back({std::min(i, j), std::max(i, j)});
    return true;
  });
  std::sort(found.begin(), found.end());
  CHECK(found == expected);
  CHECK(expected.size() > 400);
}

TEST_CASE("no boxes, no pairs") {
  for_each_overlap({}, [](int, int) {
    FAIL("visited");
    return true;
  });
}

TEST_CASE("so many pairs are counted and no more, seed 12") {
  std::mt19937_64 random(12);
  const auto unit = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  TriangleMesh mesh;
  for (int i = 0; i < 2000; ++i) {
    for (int k = 0; k < 3; ++k) {
      const double x = unit(), y = unit();
      mesh.vertices.emplace_back(x, y, unit());
    }
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  CHECK(self_intersections(mesh, std::vector<bool>(2000, false)).size() == most_pairs);
}

TEST_CASE("long faces side by side in one plane do not intersect, however many") {
  TriangleMesh strips, fan;
  fan.vertices.emplace_back(0, 0, 0);
  for (int i = 0; i < 2000; ++i) {
    const double x = 1e-3 * i, width = 3e-4;
    strips.vertices.insert(strips.vertices.end(), {{x, -x, 0}, {1 + x, 1 - x, 0}, {1 + x + width, 1 - x - width, 0}});
    strips.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    const double angle = 0.75e-3 * i;
    fan.vertices.emplace_back(std::cos(angle), std::sin(angle), 0);
    if (i > 0) fan.triangles.push_back({0, i, i + 1});
  }
  CHECK(self_intersections(strips, std::vector<bool>(2000, false)).empty());
  CHECK(self_intersections(fan, std::vector<bool>(1999, false)).empty());
  fan.triangles.push_back({0, 500, 502});
  CHECK(self_intersections(fan, std::vector<bool>(2000, false)).size() == 2);
}
