#include "offline/pipeline/vertex_map.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <set>
#include <string>

#include "formats/mesh/surface_io.hpp"
#include "formats/mesh/test_files.hpp"
#include "formats/write/model_file.hpp"
#include "offline/pipeline/build_model_file.hpp"
#include "runtime/surface/closest_point.hpp"

namespace greenloop::offline {
namespace {

// a tetrahedron split twice at its edges' middles, in metres
SemiRegularMesh split_tetrahedron() {
  SemiRegularMesh mesh;
  mesh.positions = {{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}, {0, 0, 0.1}};
  mesh.parents.assign(4, {-1, -1});
  mesh.vertex_end = {4};
  mesh.base_triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  for (int level = 0; level < 2; ++level) {
    std::set<std::array<int, 2>> edges;
    for (const auto& t : triangles_of_level(mesh, level)) {
      for (int k = 0; k < 3; ++k) edges.insert({std::min(t[k], t[(k + 1) % 3]), std::max(t[k], t[(k + 1) % 3])});
    }
    for (const auto& edge : edges) {
      mesh.positions.emplace_back((mesh.positions[edge[0]] + mesh.positions[edge[1]]) / 2);
      mesh.parents.push_back(edge);
    }
    mesh.vertex_end.push_back(mesh.positions.size());
  }
  return mesh;
}

double least_squared_distance(const SemiRegularMesh& mesh, const Eigen::Vector3d& from) {
  double least = HUGE_VAL;
  for (const auto& t : triangles_of_level(mesh, mesh.finest_level())) {
    Double3 corner[3];
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d offset = mesh.positions[t[k]] - from;
      corner[k] = {offset[0], offset[1], offset[2]};
    }
    least = std::min(least, closest_to_origin(corner).squared_distance);
  }
  return least;
}

Eigen::Vector3d place(const layout::VertexRecord& record, const std::vector<Eigen::Vector3d>& positions) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int k = 0; k < 3; ++k) sum += double{record.weight[k]} * positions[record.node[k]];
  return sum;
}

TEST_CASE("vertex map: every vertex of the file, used or not, has the nearest point of the finest level") {
  const auto folder = scratch_folder("vertex_map_test");
  TriangleMesh surface;
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> centimetres(-5, 15);
  for (int i = 0; i < 200; ++i) {
    surface.vertices.emplace_back(centimetres(random), centimetres(random), centimetres(random));
  }
  surface.triangles = {{0, 1, 2}};
  write_surface(folder / "points.off", surface);
  MeshSource source;
  source.path = folder / "points.off";
  source.unit = 0.01;
  const SemiRegularMesh model = split_tetrahedron();
  std::set<std::set<std::uint32_t>> triangles;
  for (const auto& [a, b, c] : triangles_of_level(model, 2)) triangles.insert({unsigned(a), unsigned(b), unsigned(c)});
  const auto map = vertex_map(source, model);
  REQUIRE(map.size() == 200);
  for (std::size_t i = 0; i < map.size(); ++i) {
    const auto& node = map[i].node;
    CHECK(triangles.count({node[0], node[1], node[2]}) == 1);
    const Eigen::Vector3d vertex = 0.01 * surface.vertices[i];
    const double found = (place(map[i], model.positions) - vertex).norm();
    CHECK(found == doctest::Approx(std::sqrt(least_squared_distance(model, vertex))).epsilon(1e-6));
  }
}

TEST_CASE("vertex map: a build keeps it only if the scene asks, and solves nothing again for it") {
  const auto folder = scratch_folder("vertex_map_build_test");
  const SemiRegularMesh body = split_tetrahedron();
  const TriangleMesh surface{body.positions, triangles_of_level(body, 2)};
  write_surface(folder / "body.off", surface);
  const auto build = [&](const std::string& model, const std::string& more) {
    std::ofstream(folder / "body.toml") << "[surface]\nfile = \"body.off\"\nunit = \"m\"\n" + more +
                                               "[remesh]\nbase_vertices = 4\nlevels = 2\n"
                                               "[material]\nyoung = \"20 kPa\"\npoisson = 0.4\n"
                                               "[[fixed]]\nbelow = 0.2\naxis = \"z\"\n"
                                               "[compression]\nwavelet = \"lifted linear\"\n";
    ProgressBar quiet(true);
    return build_model_file({.scene = folder / "body.toml", .model = folder / model, .store = folder / "body.h5"},
                            quiet);
  };
  build("without.gloop", "");
  const auto record = build("with.gloop", "keep_vertex_map = true\n").record;
  CHECK(record["solve"]["columns_solved"] == 0);
  const ModelFile without = open_model_file(folder / "without.gloop"), with = open_model_file(folder / "with.gloop");
  CHECK(without.view.vertices.empty());
  REQUIRE(with.view.vertices.size() == surface.vertices.size());
  CHECK(with.view.header->section_count == without.view.header->section_count + 1);
  std::vector<Eigen::Vector3d> positions;
  for (std::uint32_t q = 0; q < with.view.levels; ++q) {
    const LevelView& level = with.view.level[q];
    for (std::uint32_t i = 0; i < level.counts->node_count; ++i) {
      const float* x = level.nodes[i].position;
      positions.emplace_back(x[0], x[1], x[2]);
    }
  }
  for (std::size_t i = 0; i < surface.vertices.size(); ++i) {
    CHECK((place(with.view.vertices[i], positions) - surface.vertices[i]).norm() < 1e-7);
  }
}

}  // namespace
}  // namespace greenloop::offline
