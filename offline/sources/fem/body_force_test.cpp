// What a uniform force on the volume of a body does, against the column under its own weight, reciprocity and an
// oblique force.

#include <doctest/doctest.h>

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "offline/sources/fem/fem_source.hpp"
#include "offline/volume/testing/shapes.hpp"

namespace greenloop::offline {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

// a column 1 x 1 x 2 m that stands on its base; every vertex is a row, those on top carry loads
struct Column {
  static constexpr double height = 2;
  TetrahedralMesh mesh;
  std::vector<std::uint8_t> fixed;
  std::vector<int> rows, top;
  Interpolation every_vertex;
  MeshEdges edges;

  explicit Column(int cells) : mesh(testing::box({cells, cells, 2 * cells}, {1, 1, height})), edges(list_edges(mesh)) {
    const int count = static_cast<int>(mesh.vertices.size());
    rows.resize(mesh.vertices.size());
    std::iota(rows.begin(), rows.end(), 0);
    every_vertex = select_first_vertices(count, count);
    for (int v = 0; v < count; ++v) {
      fixed.push_back(mesh.vertices[v].z() == 0 ? 1 : 0);
      if (mesh.vertices[v].z() == height) top.push_back(v);
    }
  }

  [[nodiscard]] FemProblem problem(const Material& material, Elements elements) const {
    return {mesh, fixed, every_vertex, material, rows, top, elements};
  }
};

// u_z at height z of a column without lateral strain that 1 N/m^3 presses down
double pressed_column(double z, double young) { return -(Column::height * z - z * z / 2) / young; }

struct Deviation {
  double largest = 0, mean = 0;  // of the vertices; of u_z over the vertices, with its sign
};

// over the displacement of the top
Deviation column_error(int cells, Elements elements) {
  const Column column(cells);
  constexpr double young = 3;
  const double top = std::abs(pressed_column(Column::height, young));
  const MatrixXd moved = FemSource(column.problem({young, 0}, elements)).body_force();
  Deviation deviation;
  for (std::size_t v = 0; v < column.rows.size(); ++v) {
    const Vector3d expected(0, 0, pressed_column(column.mesh.vertices[v].z(), young));
    const Vector3d error = -moved.col(2).segment<3>(3 * static_cast<Index>(v)) - expected;
    deviation.largest = std::max(deviation.largest, error.norm() / top);
    deviation.mean += error.z() / top / static_cast<double>(column.rows.size());
  }
  return deviation;
}

TEST_CASE("a column without lateral strain under its own weight: elements converge, quadratic ones sooner") {
  const Deviation linear[] = {column_error(4, Elements::linear), column_error(8, Elements::linear)};
  const Deviation quadratic[] = {column_error(2, Elements::quadratic), column_error(4, Elements::quadratic)};
  MESSAGE("linear, 4 and 8 cells across: " << 100 * linear[0].largest << ", " << 100 * linear[1].largest
                                           << " %; quadratic, 2 and 4: " << 100 * quadratic[0].largest << ", "
                                           << 100 * quadratic[1].largest << " %");
  CHECK(linear[0].largest < 0.1);  // all cells are split alike, so the column leans
  CHECK(linear[1].largest < linear[0].largest / 3);
  CHECK(std::abs(linear[0].mean) < 1e-4);
  CHECK(quadratic[0].largest < 0.015);
  CHECK(quadratic[1].largest < quadratic[0].largest / 3.9);
}

TEST_CASE("quadratic elements hold the column's displacement exactly, but for how surface nodes read it") {
  const Column column(2);
  constexpr double young = 3;
  const FemProblem problem = column.problem({young, 0}, Elements::quadratic);
  const FreePoints free = free_points(problem, column.edges);
  VectorXd exact = VectorXd::Zero(free.count);
  for (std::size_t v = 0; v < column.rows.size(); ++v) {
    if (free.vertex[v] >= 0) exact[free.vertex[v]] = pressed_column(column.mesh.vertices[v].z(), young);
  }
  for (std::size_t e = 0; e < column.edges.ends.size(); ++e) {
    if (free.edge[e] < 0) continue;
    const double a = column.mesh.vertices[column.edges.ends[e][0]].z();
    const double b = column.mesh.vertices[column.edges.ends[e][1]].z();
    exact[free.edge[e]] =
        pressed_column((a + b) / 2, young) - (pressed_column(a, young) + pressed_column(b, young)) / 2;
  }
  const VectorXd read = nodes_from_points(problem, column.edges, free) * exact;
  const MatrixXd moved = FemSource(problem).body_force();
  for (Index v = 0; v < read.size(); ++v) {
    CHECK(-moved(3 * v + 2, 2) == doctest::Approx(read[v]).epsilon(1e-10));
    CHECK(std::abs(moved(3 * v, 2)) < 1e-10);
  }
}

TEST_CASE("reciprocity: the work of a body force under a load is that of the load under the body force") {
  const Column column(2);
  for (const Elements elements : {Elements::linear, Elements::quadratic}) {
    const FemProblem problem = column.problem({2, 0.4}, elements);
    const FreePoints free = free_points(problem, column.edges);
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower> factors(
        assemble_stiffness(problem, column.edges, free));
    const Interpolation read = nodes_from_points(problem, column.edges, free);
    const VectorXd volumes = point_volumes(problem, column.edges, free);
    const MatrixXd moved = FemSource(problem).body_force();
    for (const int node : {column.top.front(), column.top[column.top.size() / 2]}) {
      for (Index load = 0; load < 3; ++load) {
        VectorXd forces = VectorXd::Zero(Index{3} * free.count);
        for (Interpolation::InnerIterator it(read, node); it; ++it) forces[3 * it.col() + load] = it.value();
        const VectorXd under_load = factors.solve(forces);
        for (Index axis = 0; axis < 3; ++axis) {
          double work = 0;
          for (Index p = 0; p < volumes.size(); ++p) work += volumes[p] * under_load[3 * p + axis];
          CHECK(moved(Index{3} * node + load, axis) == doctest::Approx(work).epsilon(1e-9).scale(1e-3));
        }
      }
    }
  }
}

TEST_CASE("a body force weighs the whole body, and an oblique one is the sum of its components") {
  const Column column(2);
  const std::vector<std::uint8_t> nothing(column.fixed.size(), 0);
  for (const Elements elements : {Elements::linear, Elements::quadratic}) {
    FemProblem problem = column.problem({2, 0.4}, elements);
    const FemProblem loose{column.mesh, nothing, column.every_vertex, {2, 0.4}, column.rows, column.top, elements};
    const FreePoints all = free_points(loose, column.edges);
    // a displacement that is one everywhere has no share of edges
    CHECK(point_volumes(loose, column.edges, all).head(static_cast<Index>(column.rows.size())).sum() ==
          doctest::Approx(Column::height));

    const Vector3d oblique(0.6, -0.2, -0.7);
    const FreePoints free = free_points(problem, column.edges);
    const VectorXd volumes = point_volumes(problem, column.edges, free);
    VectorXd forces(Index{3} * free.count);
    for (Index p = 0; p < volumes.size(); ++p) forces.segment<3>(3 * p) = volumes[p] * oblique;
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower> factors(
        assemble_stiffness(problem, column.edges, free));
    const VectorXd solved = factors.solve(forces);
    const Interpolation read = nodes_from_points(problem, column.edges, free);
    const VectorXd tilted = FemSource(problem).body_force() * oblique;
    for (Index node = 0; node < read.rows(); ++node) {
      Vector3d expected = Vector3d::Zero();
      for (Interpolation::InnerIterator it(read, node); it; ++it)
        expected += it.value() * solved.segment<3>(3 * it.col());
      CHECK((tilted.segment<3>(3 * node) - expected).norm() < 1e-9);
    }
  }
}

}  // namespace
}  // namespace greenloop::offline
