#include "offline/remesh/subdivision_connectivity.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <numbers>
#include <numeric>
#include <random>
#include <set>
#include <stdexcept>

#include "formats/mesh/surface_io.hpp"
#include "offline/remesh/midpoint_refinement.hpp"

namespace greenloop::offline {
namespace {

TriangleMesh data_mesh(const char* name) {
  const char* folder = std::getenv("GREENLOOP_DATA");
  REQUIRE_MESSAGE(folder != nullptr, "GREENLOOP_DATA must name the folder that ./dev data fills");
  return read_surface(std::filesystem::path(folder) / name);
}

TriangleMesh octahedron() {
  return {{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
          {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}};
}

/// A torus of rows x columns squares, each cut in two: every vertex has six neighbours.
TriangleMesh torus(int rows, int columns) {
  TriangleMesh mesh;
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      const double u = 2 * std::numbers::pi * i / rows, v = 2 * std::numbers::pi * j / columns;
      mesh.vertices.emplace_back((3 + std::cos(v)) * std::cos(u), (3 + std::cos(v)) * std::sin(u), std::sin(v));
    }
  }
  const auto at = [&](int i, int j) { return (i % rows) * columns + j % columns; };
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh;
}

TriangleMesh split(const TriangleMesh& mesh, int levels) {
  auto refined = refine_midpoints(mesh.triangles, static_cast<int>(mesh.vertices.size()), levels).mesh;
  for (std::size_t v = 0; v < refined.positions.size(); ++v) {
    const auto& [a, b] = refined.parents[v];
    refined.positions[v] =
        a < 0 ? mesh.vertices[v] : Eigen::Vector3d((refined.positions[a] + refined.positions[b]) / 2);
  }
  return {refined.positions, triangles_of_level(refined, levels)};
}

/// The same surface with vertices renumbered, triangles reordered and their first corners chosen anew.
TriangleMesh shuffled(const TriangleMesh& mesh, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto shuffle = [&](auto& items) {
    for (std::size_t k = items.size(); k > 1; --k) std::swap(items[k - 1], items[random() % k]);
  };
  std::vector<int> place(mesh.vertices.size());
  std::iota(place.begin(), place.end(), 0);
  shuffle(place);
  TriangleMesh result{mesh.vertices, mesh.triangles};
  for (std::size_t v = 0; v < place.size(); ++v) result.vertices[place[v]] = mesh.vertices[v];
  for (auto& corners : result.triangles) {
    for (int& v : corners) v = place[v];
    std::rotate(corners.begin(), corners.begin() + random() % 3, corners.end());
  }
  shuffle(result.triangles);
  return result;
}

using Place = std::array<double, 3>;

/// The triangles by positions, each from its smallest corner on.
std::multiset<std::array<Place, 3>> soup(const std::vector<Eigen::Vector3d>& vertices,
                                         const std::vector<std::array<int, 3>>& triangles) {
  std::multiset<std::array<Place, 3>> all;
  for (const auto& corners : triangles) {
    std::array<Place, 3> places;
    for (int c = 0; c < 3; ++c) {
      const auto& p = vertices[corners[c]];
      places[c] = {p.x(), p.y(), p.z()};
    }
    std::rotate(places.begin(), std::min_element(places.begin(), places.end()), places.end());
    all.insert(places);
  }
  return all;
}

void check_kept(const TriangleMesh& mesh, int asked, int levels, std::size_t base_triangles) {
  const auto found = find_subdivision_connectivity(mesh, asked);
  REQUIRE(found.has_value());
  CHECK(found->finest_level() == levels);
  CHECK(found->base_triangles.size() == base_triangles);
  CHECK(found->vertex_end.back() == mesh.vertices.size());
  CHECK(found->parents.size() == mesh.vertices.size());
  for (std::size_t v = found->vertex_end[0]; v < found->parents.size(); ++v) {
    CHECK(found->parents[v][0] < found->parents[v][1]);
    CHECK(found->parents[v][1] < static_cast<int>(v));
  }
  CHECK((soup(found->positions, triangles_of_level(*found, levels)) == soup(mesh.vertices, mesh.triangles)));
}

}  // namespace

TEST_CASE("geosphere.off is an icosahedron split twice") {
  const auto mesh = data_mesh("meshes/geosphere.off");
  check_kept(mesh, 5, 2, 20);
  check_kept(mesh, 2, 2, 20);
  check_kept(mesh, 1, 1, 80);
}

TEST_CASE("an octahedron split three times is recognised in any order of its vertices") {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    CAPTURE(seed);
    check_kept(shuffled(split(octahedron(), 3), seed), 9, 3, 8);
  }
}

TEST_CASE("a torus without any extraordinary vertex is recognised") {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    CAPTURE(seed);
    check_kept(shuffled(torus(24, 12), seed), 9, 2, 36);  // 6 x 3 squares are the smallest valid base
    check_kept(shuffled(split(torus(3, 5), 2), seed), 9, 2, 30);
  }
}

TEST_CASE("among splits of equal depth the one with odd vertices in the middle is taken") {
  const auto coarse = torus(5, 3);
  const auto found = find_subdivision_connectivity(shuffled(split(coarse, 1), 7), 3);
  REQUIRE(found.has_value());
  const std::vector<Eigen::Vector3d> base(found->positions.begin(), found->positions.begin() + 15);
  CHECK((soup(base, found->base_triangles) == soup(coarse.vertices, coarse.triangles)));
}

TEST_CASE("surfaces without subdivision connectivity are not mistaken for it") {
  CHECK(!find_subdivision_connectivity(octahedron(), 3).has_value());
  CHECK(!find_subdivision_connectivity(data_mesh("bunny.obj"), 3).has_value());
  CHECK(!find_subdivision_connectivity(data_mesh("meshes/elephant.off"), 3).has_value());
  CHECK(!find_subdivision_connectivity(torus(7, 9), 3).has_value());
  CHECK(!find_subdivision_connectivity(split(octahedron(), 2), 0).has_value());
}

TEST_CASE("one flipped edge ends the recognition") {
  auto mesh = split(octahedron(), 2);
  auto& s = mesh.triangles[5];
  // the triangle across the edge from corner 0 to corner 1
  for (auto& t : mesh.triangles) {
    for (int c = 0; c < 3; ++c) {
      if (t[c] != s[1] || t[(c + 1) % 3] != s[0]) continue;
      const int a = s[0], b = s[1], above = s[2], below = t[(c + 2) % 3];
      s = {above, a, below};
      t = {below, b, above};
      CHECK(!find_subdivision_connectivity(mesh, 2).has_value());
      return;
    }
  }
  FAIL("the surface is closed, so there is a triangle across every edge");
}

TEST_CASE("an open surface is refused") {
  auto mesh = split(octahedron(), 1);
  mesh.triangles.resize(mesh.triangles.size() - 4);
  CHECK_THROWS_AS((void)find_subdivision_connectivity(mesh, 2), std::invalid_argument);
}

}  // namespace greenloop::offline
