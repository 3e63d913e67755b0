// Surfaces in needles, as drawing programs and spheres by longitude make them, in even triangles.
#include "offline/remesh/even_mesh.hpp"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <vector>

#include "formats/mesh/triangle_mesh.hpp"
#include "offline/remesh/feature_curves.hpp"
#include "offline/remesh/quality.hpp"
#include "offline/remesh/surface.hpp"
#include "offline/remesh/test_drawings.hpp"
#include "offline/remesh/triangle_tree.hpp"
#include "offline/surface/area_and_volume.hpp"
#include "offline/surface/surface_report.hpp"

namespace greenloop::offline {
namespace {

/// An original, its chains, and its even mesh.
struct Evened {
  Evened(const TriangleMesh& mesh, double edge_length)
      : features(find_features(mesh, 40, 1)),
        original(mesh, edges_of(features)),
        curves(original.mesh(), features.chains),
        tree(original.mesh()),
        even(even_mesh(original, features, curves, edge_length)) {}

  static std::vector<std::array<int, 2>> edges_of(const Features& features) {
    std::vector<std::array<int, 2>> edges;
    for (const auto& chain : features.chains) {
      for (std::size_t k = 1; k < chain.vertices.size(); ++k)
        edges.push_back({chain.vertices[k - 1], chain.vertices[k]});
    }
    return edges;
  }

  Features features;
  Surface original;
  FeatureCurves curves;
  TriangleTree tree;
  EvenMesh even;
};

/// A ball of radius 10 in slices: two fans of needles to the poles and belts of long triangles.
TriangleMesh sliced_ball(int slices, int belts) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 10}, {0, 0, -10}};
  for (int k = 1; k < belts; ++k) {
    const double polar = std::numbers::pi * k / belts;
    for (int s = 0; s < slices; ++s) {
      const double turn = 2 * std::numbers::pi * s / slices;
      mesh.vertices.emplace_back(10 * std::sin(polar) * std::cos(turn), 10 * std::sin(polar) * std::sin(turn),
                                 10 * std::cos(polar));
    }
  }
  const auto at = [&](int k, int s) { return 2 + (k - 1) * slices + s % slices; };
  for (int s = 0; s < slices; ++s) {
    mesh.triangles.push_back({0, at(1, s), at(1, s + 1)});
    mesh.triangles.push_back({1, at(belts - 1, s + 1), at(belts - 1, s)});
    for (int k = 1; k + 1 < belts; ++k) {
      mesh.triangles.push_back({at(k, s), at(k + 1, s), at(k + 1, s + 1)});
      mesh.triangles.push_back({at(k, s), at(k + 1, s + 1), at(k, s + 1)});
    }
  }
  return mesh;
}

double longest_edge(const TriangleMesh& mesh) {
  double longest = 0;
  for (const auto& t : mesh.triangles) {
    for (int c = 0; c < 3; ++c)
      longest = std::max(longest, (mesh.vertices[t[c]] - mesh.vertices[t[(c + 1) % 3]]).norm());
  }
  return longest;
}

/// Even, closed, without crossings, on the original, of as many triangles as such an edge makes; its angles in degrees.
void check_even(const Evened& evened, double edge_length, double least_angle = 25) {
  const TriangleMesh& mesh = evened.even.mesh;
  CHECK(evened.even.settled);
  const SurfaceReport report = check_surface(mesh);
  CHECK(report.closed());
  CHECK(report.manifold());
  CHECK(report.oriented());
  CHECK(report.intersecting_faces.empty());
  CHECK(report.volume > 0);
  CHECK(report.genus() == check_connectivity(evened.original.mesh()).genus());
  const double equilateral = std::sqrt(3.0) / 4 * edge_length * edge_length;
  const double triangles = surface_area(mesh) / equilateral;
  CHECK(static_cast<double>(mesh.triangles.size()) < 1.5 * triangles);
  CHECK(static_cast<double>(mesh.triangles.size()) > triangles / 1.5);
  CHECK(longest_edge(mesh) < 1.4 * edge_length);
  CHECK(smallest_angle(mesh) > least_angle);
  double off = 0;
  for (const auto& v : mesh.vertices) off = std::max(off, evened.tree.distance(v));
  CHECK(off < 1e-9);
  MESSAGE(mesh.triangles.size() << " of " << triangles << " triangles, longest edge "
                                << longest_edge(mesh) / edge_length << ", smallest angle " << smallest_angle(mesh)
                                << " degrees");
}

}  // namespace

TEST_CASE("the needles of a drawing become even triangles, its edges, rims and corners stay") {
  const auto mesh = box_with_hole({40, 30, 10}, 12, 96);
  REQUIRE(smallest_angle(mesh) < 2);
  const Evened evened(mesh, 3);
  check_even(evened, 3);
  const auto& even = evened.even;
  CHECK(even.features.corner_count() == 8);
  REQUIRE(even.features.chains.size() == evened.features.chains.size());
  for (std::size_t c = 0; c < even.features.chains.size(); ++c) {
    const auto& chain = even.features.chains[c];
    CHECK(chain.loop == evened.features.chains[c].loop);
    CHECK(chain.lengths.back() == doctest::Approx(evened.features.chains[c].lengths.back()).epsilon(0.01));
    for (const int v : chain.vertices) {
      if (even.features.corners[v] != 0) continue;
      const auto nearest = evened.curves.closest(static_cast<int>(c), even.mesh.vertices[v]);
      CHECK((evened.original.position(evened.curves.point(nearest)) - even.mesh.vertices[v]).norm() < 1e-9);
    }
  }
  // flat faces between straight edges: what is lost is in the facets of the hole
  CHECK(enclosed_volume(even.mesh) == doctest::Approx(enclosed_volume(mesh)).epsilon(2e-3));
}

TEST_CASE("the sides of a thin plate stay apart, in triangles as wide as its walls and no longer than asked") {
  const double thickness = 1, edge_length = 3, longest = 4.0 / 3 * edge_length;
  const Evened evened(box_with_hole({40, 30, thickness / 2}, 5, 48), edge_length);
  check_even(evened, edge_length, std::atan2(thickness, longest) * 180 / std::numbers::pi / 2);
}

TEST_CASE("a ball in slices becomes even triangles, with fewer and with more of them") {
  const auto ball = sliced_ball(200, 7);
  REQUIRE(smallest_angle(ball) < 2);
  for (const double edge_length : {3.0, 0.8}) {
    CAPTURE(edge_length);
    check_even(Evened(ball, edge_length), edge_length);
  }
}

TEST_CASE("what was even stays as large, and the same input gives the same bits") {
  const Evened first(box_with_hole({40, 30, 10}, 12, 32), 3), again(box_with_hole({40, 30, 10}, 12, 32), 3);
  CHECK(first.even.mesh.vertices == again.even.mesh.vertices);
  CHECK(first.even.mesh.triangles == again.even.mesh.triangles);
  const Evened twice(first.even.mesh, 3);
  check_even(twice, 3);
}

TEST_CASE("a place of the even mesh is found on the original, on its chain if it has one") {
  const Evened evened(box_with_hole({40, 30, 10}, 12, 32), 3);
  const auto& mesh = evened.even.mesh;
  const auto& chains = evened.even.features.chains;
  std::vector<char> seen(mesh.vertices.size(), 0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (int c = 0; c < 3; ++c) {
      const int v = mesh.triangles[t][c];
      if (seen[v]++ != 0) continue;
      const BoundPoint here{{static_cast<int>(t), Eigen::Vector3d::Unit(c)}, {}};
      const auto back = evened.even.on_original(here, evened.curves, evened.tree);
      CHECK((evened.original.position(back) - mesh.vertices[v]).norm() < 1e-9);
    }
  }
  // halfway between two vertices of a rim: on the rim's facets, not on the chord between them
  const auto loop = std::find_if(chains.begin(), chains.end(), [](const auto& c) { return c.loop; });
  REQUIRE(loop != chains.end());
  const int chain = static_cast<int>(loop - chains.begin());
  const int v = loop->vertices[0], w = loop->vertices[1];
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (int c = 0; c < 3; ++c) {
      if (mesh.triangles[t][c] != v || mesh.triangles[t][(c + 1) % 3] != w) continue;
      const Eigen::Vector3d half = (Eigen::Vector3d::Unit(c) + Eigen::Vector3d::Unit((c + 1) % 3)) / 2;
      const BoundPoint here{{static_cast<int>(t), half}, {chain, 0, -1}};
      const auto place = evened.original.position(evened.even.on_original(here, evened.curves, evened.tree));
      const auto nearest = evened.original.position(evened.curves.point(evened.curves.closest(chain, place)));
      CHECK((place - nearest).norm() < 1e-9);
    }
  }
}

}  // namespace greenloop::offline
