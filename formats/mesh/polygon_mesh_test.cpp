#include "formats/mesh/polygon_mesh.hpp"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "formats/mesh/test_files.hpp"

using namespace greenloop;
using Eigen::Vector3d;

namespace {

TriangleMesh cut(std::vector<Vector3d> vertices, const std::vector<int>& polygon) {
  PolygonMesh mesh;
  mesh.vertices = std::move(vertices);
  mesh.add(polygon, 7);
  MeshNotes notes;
  return triangulate("a.off", std::move(mesh), notes);
}

std::vector<int> all(std::size_t count, std::size_t first = 0) {
  std::vector<int> polygon;
  for (std::size_t i = 0; i < count; ++i) polygon.push_back(static_cast<int>((i + first) % count));
  return polygon;
}

Vector3d twice_area(const TriangleMesh& mesh, std::size_t f) {
  const auto& [a, b, c] = mesh.triangles[f];
  return (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]);
}

/// Triangles of a flat polygon that look one way, and their area together.
double area_of_flat(const TriangleMesh& mesh, const Vector3d& normal) {
  double area = 0;
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    const Vector3d a = twice_area(mesh, f);
    CHECK(a.dot(normal) > 0);
    area += a.norm() / 2;
  }
  return area;
}

const std::vector<Vector3d> ell{{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}};

}  // namespace

TEST_CASE("a convex polygon is a fan around its first corner") {
  const auto mesh = cut({{0, 0, 0}, {1, 0, 0}, {2, 1, 0}, {1, 2, 0}, {0, 1, 0}}, {4, 0, 1, 2, 3});
  CHECK(mesh.triangles == std::vector<std::array<int, 3>>{{4, 0, 1}, {4, 1, 2}, {4, 2, 3}});
}

TEST_CASE("a concave polygon keeps its area and its side, from whatever corner it starts, wherever it lies") {
  const Eigen::AngleAxisd turn(0.7, Vector3d(1, 2, 3).normalized());
  for (std::size_t first = 0; first < ell.size(); ++first) {
    for (const bool backwards : {false, true}) {
      CAPTURE(first);
      auto polygon = all(ell.size(), first);
      auto vertices = ell;
      for (auto& v : vertices) v = turn * v + Vector3d(100, 0, -3);
      if (backwards) std::reverse(polygon.begin(), polygon.end());
      const auto mesh = cut(vertices, polygon);
      CHECK(mesh.triangles.size() == 4);
      CHECK(area_of_flat(mesh, turn * Vector3d(0, 0, backwards ? -1 : 1)) == doctest::Approx(3));
    }
  }
}

TEST_CASE("corners on a straight side do not become faces without area") {
  const auto mesh = cut({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 2, 0}, {1, 2, 0}, {0, 2, 0}}, all(6));
  CHECK(mesh.triangles.size() == 4);
  CHECK(area_of_flat(mesh, Vector3d::UnitZ()) == doctest::Approx(4));
}

TEST_CASE("stars of many corners, seed 3") {
  std::mt19937_64 random(3);
  for (int trial = 0; trial < 200; ++trial) {
    const std::size_t n = 5 + random() % 60;
    std::vector<Vector3d> vertices;
    double area = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const double angle = 2 * std::acos(-1.0) * static_cast<double>(i) / static_cast<double>(n);
      const double radius = 0.1 + static_cast<double>(random() % 1000) / 1000;
      vertices.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 1);
    }
    for (std::size_t i = 0; i < n; ++i) area += vertices[i].cross(vertices[(i + 1) % n]).z() / 2;
    const auto mesh = cut(vertices, all(n, random() % n));
    CAPTURE(trial);
    CHECK(mesh.triangles.size() == n - 2);
    CHECK(area_of_flat(mesh, Vector3d::UnitZ()) == doctest::Approx(area));
  }
}

TEST_CASE("a hole reached over a bridge stays a hole") {
  const std::vector<Vector3d> frame{{0, 0, 0}, {3, 0, 0}, {3, 3, 0}, {0, 3, 0},
                                    {1, 1, 0}, {1, 2, 0}, {2, 2, 0}, {2, 1, 0}};
  const auto mesh = cut(frame, {0, 1, 2, 3, 0, 4, 5, 6, 7, 4});
  CHECK(area_of_flat(mesh, Vector3d::UnitZ()) == doctest::Approx(8));
}

TEST_CASE("a polygon that is not flat is cut as it is seen along its area's normal") {
  auto bent = ell;
  for (auto& v : bent) v.z() = 0.1 * v.x() * v.y();
  const auto mesh = cut(bent, all(6));
  CHECK(mesh.triangles.size() == 4);
  for (std::size_t f = 0; f < 4; ++f) CHECK(twice_area(mesh, f).z() > 0);
}

TEST_CASE("corners on one line are left to the surface's check") {
  CHECK(cut({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}, all(4)).triangles.size() == 2);
}

TEST_CASE("corners that repeat are left out, and a face without three is dropped and noted") {
  PolygonMesh mesh;
  mesh.vertices = ell;
  mesh.add(std::array{0, 1, 1, 2}, 1);
  mesh.add(std::array{3, 3, 4, 3}, 2);
  MeshNotes notes;
  const auto result = triangulate("a.off", std::move(mesh), notes);
  CHECK(result.triangles == std::vector<std::array<int, 3>>{{0, 1, 2}});
  CHECK(notes == MeshNotes{"a.off: 1 face of fewer than three different corners dropped"});
}

TEST_CASE("refused: polygons that cross themselves, with their place") {
  for (const double skew : {0.0, 0.5}) {
    check_refused(
        [&] {
          return cut({{0, 0, 0}, {1, 1 + skew, 0}, {1, 0, 0}, {0, 1, 0}}, all(4));
        },
        "a.off:7: found face 0 (counted from 0) of 4 corners that crosses itself, expected a simple polygon");
  }
  std::vector<Vector3d> pentagram;
  for (int i = 0; i < 5; ++i) pentagram.emplace_back(std::cos(i * 2.513), std::sin(i * 2.513), 0);
  check_refused([&] { return cut(pentagram, all(5)); }, "crosses itself");
}

TEST_CASE("refused: more corners than can be cut in a time in proportion") {
  std::vector<Vector3d> comb;
  for (std::size_t i = 0; i < most_corners; ++i) comb.emplace_back(i, i % 2, 0);
  comb.emplace_back(0, 5000, 0);
  check_refused([&] { return cut(comb, all(comb.size())); }, "more corners than can be cut");
  comb.erase(comb.begin());
  CHECK(cut(comb, all(comb.size())).triangles.size() == most_corners - 2);
}
