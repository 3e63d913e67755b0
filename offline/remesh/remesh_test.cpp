#include "offline/remesh/remesh.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "formats/mesh/surface_io.hpp"

namespace greenloop::offline {
namespace {

TriangleMesh fetched(const std::string& name) {
  const char* folder = std::getenv("GREENLOOP_DATA");
  REQUIRE_MESSAGE(folder != nullptr, "GREENLOOP_DATA is not set; run the tests through ./dev test");
  return read_surface(std::filesystem::path(folder) / name);
}

/// What every remeshed surface has to be.
void check_sound(const Remeshed& remeshed, int levels, int genus) {
  const auto& mesh = remeshed.mesh;
  REQUIRE(mesh.finest_level() == levels);
  const auto euler = 2 - 2 * genus;
  for (int l = 1; l <= levels; ++l) {
    const auto coarse = static_cast<int>(mesh.vertex_end[l - 1]), fine = static_cast<int>(mesh.vertex_end[l]);
    CHECK(fine == 4 * coarse - 3 * euler);  // V' = V + E on a closed surface with E = 3 (V - chi)
  }
  CHECK(triangles_of_level(mesh, levels).size() == remeshed.quality.triangles);
  CHECK(remeshed.quality.flipped == 0);
  CHECK(remeshed.quality.self_intersections == 0);
  CHECK(remeshed.quality.smallest_angle_degrees >= 8);
}

void check_remeshed(const std::string& name, int levels, int genus, int most_base_vertices, double most_distance) {
  CAPTURE(name);
  RemeshOptions options;
  options.levels = levels;
  const auto remeshed = remesh(fetched(name), options);
  check_sound(remeshed, levels, genus);
  CHECK(remeshed.quality.base_vertices <= most_base_vertices);
  CHECK(remeshed.quality.hausdorff_relative <= most_distance);
  MESSAGE(name << ", " << levels << " levels over " << remeshed.quality.base_vertices << ": smallest angle "
               << remeshed.quality.smallest_angle_degrees << " degrees, Hausdorff distance "
               << 100 * remeshed.quality.hausdorff_relative << " % of the diagonal");
}

std::vector<Eigen::Vector3d> sorted(std::vector<Eigen::Vector3d> points) {
  std::sort(points.begin(), points.end(), [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  });
  return points;
}

}  // namespace

TEST_CASE("the bear over at most 50 base vertices") {
  check_remeshed("meshes/bear_bis.off", 3, 0, 50, 0.02);
  check_remeshed("meshes/bear_bis.off", 4, 0, 50, 0.01);
}

TEST_CASE("the bunny over at most 50 base vertices, ears included") {
  check_remeshed("bunny.obj", 3, 0, 50, 0.02);
  check_remeshed("bunny.obj", 4, 0, 50, 0.01);
}

TEST_CASE("a knotted tube keeps its genus") { check_remeshed("meshes/knot1.off", 3, 1, 50, 0.02); }

TEST_CASE("the same input gives the same bits") {
  const auto input = fetched("meshes/cactus.off");
  RemeshOptions options;
  options.levels = 2;
  const auto once = remesh(input, options), again = remesh(input, options);
  CHECK(once.mesh.positions == again.mesh.positions);
  CHECK(once.mesh.base_triangles == again.mesh.base_triangles);
}

TEST_CASE("a surface that has subdivision connectivity keeps its vertices") {
  const auto input = fetched("meshes/geosphere.off");
  RemeshOptions options;
  options.levels = 2;
  const auto kept = remesh(input, options);
  CHECK(kept.quality.kept_connectivity);
  CHECK(kept.quality.base_vertices == 12);
  CHECK(sorted(kept.mesh.positions) == sorted(input.vertices));  // kept to the bit, in another order
}

TEST_CASE("a surface's own levels serve only if they are those asked for, over a base within the limit") {
  const auto input = fetched("meshes/geosphere.off");
  RemeshOptions options;
  options.levels = 3;
  CHECK_FALSE(remesh(input, options).quality.kept_connectivity);
  CHECK(remesh(input, options).quality.levels == 3);
  options.levels = 1;
  options.base_vertices = options.most_base_vertices.emplace(41);  // one split undone leaves 42
  CHECK_FALSE(remesh(input, options).quality.kept_connectivity);
  options.most_base_vertices = 42;
  CHECK(remesh(input, options).quality.kept_connectivity);
}

TEST_CASE("a surface of few triangles is split as it is, corners and edges included") {
  const auto input = fetched("meshes/tetrahedron.off");
  const auto remeshed = remesh(input, {});
  check_sound(remeshed, 3, 0);
  CHECK(remeshed.quality.base_vertices == 34);  // split twice: another split would exceed 42
  CHECK(remeshed.quality.hausdorff_relative < 1e-12);
}

TEST_CASE("a coarse surface of genus 3 with sharp edges is split as it is") {
  const auto remeshed = remesh(fetched("meshes/3torus.off"), {});
  check_sound(remeshed, 3, 3);
  CHECK(remeshed.quality.base_vertices == 19);
}

TEST_CASE("a genus-3 surface gets the base it needs") { check_remeshed("meshes/elephant.off", 3, 3, 150, 0.02); }

TEST_CASE("what cannot be met is refused with what was reached") {
  RemeshOptions options;
  options.levels = 0;
  options.base_vertices = 8;
  options.most_base_vertices = 8;
  options.accuracy = 1e-4;
  CHECK_THROWS_WITH_AS(remesh(fetched("meshes/cactus.off"), options), doctest::Contains("Raise remesh.levels (now 0)"),
                       std::runtime_error);
  options.base_vertices = 3;
  CHECK_THROWS_AS(remesh(fetched("meshes/cactus.off"), options), std::invalid_argument);
}

}  // namespace greenloop::offline
