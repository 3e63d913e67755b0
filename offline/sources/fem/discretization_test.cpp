#include "offline/sources/fem/discretization.hpp"

#include <doctest/doctest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>

#include "offline/sources/fem/fem_source.hpp"
#include "offline/volume/testing/shapes.hpp"

namespace greenloop::offline {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

struct Body {
  TetrahedralMesh mesh;
  std::vector<std::uint8_t> fixed;
  Interpolation every_vertex;
  std::vector<int> loaded;
  MeshEdges edges;

  Body(TetrahedralMesh of, bool (*is_fixed)(const Vector3d&), bool (*is_loaded)(const Vector3d&))
      : mesh(std::move(of)),
        every_vertex(
            select_first_vertices(static_cast<int>(mesh.vertices.size()), static_cast<int>(mesh.vertices.size()))),
        edges(list_edges(mesh)) {
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
      fixed.push_back(is_fixed(mesh.vertices[v]) ? 1 : 0);
      if (is_loaded(mesh.vertices[v])) loaded.push_back(static_cast<int>(v));
    }
  }

  [[nodiscard]] FemProblem problem(const Material& material, Elements elements) const {
    return {mesh, fixed, every_vertex, material, loaded, loaded, elements};
  }

  // among the loaded vertices
  [[nodiscard]] MatrixXd compliance(const Material& material, Elements elements) const {
    FemSource source(problem(material, elements));
    std::vector<int> columns;
    for (std::size_t c = 0; c < loaded.size(); ++c) columns.push_back(static_cast<int>(c));
    return source.read(columns);
  }

  // that displaces the loaded vertices by one
  [[nodiscard]] double force(const Material& material, Elements elements, int axis) const {
    const MatrixXd given = compliance(material, elements);
    VectorXd moved = VectorXd::Zero(given.rows());
    for (Index i = axis; i < moved.size(); i += 3) moved[i] = 1;
    return moved.dot(given.llt().solve(moved));
  }
};

Body block(int cells) {
  return {testing::box({4 * cells, 4 * cells, 2 * cells}, {1, 1, 0.5}), [](const Vector3d& x) { return x.z() == 0; },
          [](const Vector3d& x) {
            return x.z() == 0.5 && std::abs(x.x() - 0.5) < 0.2501 && std::abs(x.y() - 0.5) < 0.2501;
          }};
}

Body beam(int cells_across) {
  return {testing::box({5 * cells_across, cells_across, cells_across}, {10, 1, 1}),
          [](const Vector3d& x) { return x.x() == 0; }, [](const Vector3d& x) { return x.x() == 10; }};
}

TEST_CASE("the stiffness matrix of quadratic elements gives the forces that the elements give") {
  const Body body = block(1);
  const Material material{2, 0.4};
  const FemProblem problem = body.problem(material, Elements::quadratic);
  const FreePoints free = free_points(problem, body.edges);
  const auto lower = assemble_stiffness(problem, body.edges, free);
  REQUIRE(lower.rows() == 3 * free.count);
  CHECK(unknowns(problem) == 3 * free.count);

  const QuadraticStiffness elements(body.mesh, body.edges, material);
  QuadraticField field = elements.zero();
  VectorXd moved(3 * free.count);
  for (Index i = 0; i < moved.size(); ++i) moved[i] = std::sin(3.0 * static_cast<double>(i));
  const auto each = [&](const std::vector<int>& numbers, auto&& use) {
    for (std::size_t p = 0; p < numbers.size(); ++p) {
      if (numbers[p] >= 0) use(static_cast<Index>(p), Index{3} * numbers[p]);
    }
  };
  each(free.vertex, [&](Index p, Index at) { field.vertex.col(p) = moved.segment<3>(at); });
  each(free.edge, [&](Index p, Index at) { field.edge.col(p) = moved.segment<3>(at); });
  const QuadraticField force = elements.force(field);
  VectorXd expected(moved.size());
  each(free.vertex, [&](Index p, Index at) { expected.segment<3>(at) = force.vertex.col(p); });
  each(free.edge, [&](Index p, Index at) { expected.segment<3>(at) = force.edge.col(p); });
  const VectorXd found = lower.selfadjointView<Eigen::Lower>() * moved;
  CHECK((found - expected).norm() < 1e-13 * expected.norm());
}

TEST_CASE("what fixed vertices hold: themselves and the boundary's edges between them, no edge inside") {
  const Body body = block(1);
  const FreePoints free = free_points(body.problem({1, 0.3}, Elements::quadratic), body.edges);
  for (std::size_t e = 0; e < body.edges.ends.size(); ++e) {
    const auto [a, b] = body.edges.ends[e];
    CHECK((free.edge[e] < 0) == (body.fixed[a] != 0 && body.fixed[b] != 0));  // all of those lie on the table
  }
  // both ends of a bar held: the edges inside that lead from one to the other are free
  const Body bar{testing::box({1, 1, 1}, {1, 1, 1}), [](const Vector3d& x) { return x.z() == 0 || x.z() == 1; },
                 [](const Vector3d&) { return false; }};
  const FreePoints of_bar = free_points(bar.problem({1, 0.3}, Elements::quadratic), bar.edges);
  CHECK(of_bar.count == 1);
}

TEST_CASE("a vertex of quadratic elements is read as the mean of what is around it: linear displacements exactly") {
  const Body body = block(1);
  const FemProblem problem = body.problem({1, 0.3}, Elements::quadratic);
  const FreePoints free = free_points(problem, body.edges);
  const Interpolation nodes = nodes_from_points(problem, body.edges, free);
  const Interpolation linear = nodes_from_points(body.problem({1, 0.3}, Elements::linear), body.edges,
                                                 free_points(body.problem({1, 0.3}, Elements::linear), body.edges));
  // over the vertices it is what linear elements read; over the edges, what a parabola adds to a flat side: with
  // u = x (1 - x) on edges of 1/4, hats of equal triangles around: the mean of 4 L_a L_b u_e, u_e = (1/8)^2
  CHECK((MatrixXd(nodes).leftCols(linear.cols()) - MatrixXd(linear)).norm() == 0);
  for (const int v : body.loaded) {
    double sum = 0;
    for (Interpolation::InnerIterator it(nodes, v); it; ++it) {
      if (it.col() >= linear.cols()) sum += it.value();
    }
    CHECK(sum == doctest::Approx(1.0));  // each triangle around has (2 + 2 + 1) / 15 of its area, over a third of it
  }
}

TEST_CASE("the compliance of quadratic elements is symmetric, definite and softer than that of linear ones") {
  const Body body = block(1);
  const Material material{1, 0.45};
  const MatrixXd linear = body.compliance(material, Elements::linear),
                 quadratic = body.compliance(material, Elements::quadratic);
  CHECK((quadratic - quadratic.transpose()).norm() < 1e-13 * quadratic.norm());
  const Eigen::SelfAdjointEigenSolver<MatrixXd> values(quadratic);
  CHECK(values.eigenvalues()[0] > 0);
  const Eigen::SelfAdjointEigenSolver<MatrixXd> softer(quadratic - linear);
  CHECK(softer.eigenvalues()[0] > 0);
  for (int axis = 0; axis < 3; ++axis) {
    CHECK(body.force(material, Elements::quadratic, axis) < body.force(material, Elements::linear, axis));
  }
}

TEST_CASE(
    "quadratic elements: a clamped beam of one and two cells bends as it should, also when it hardly compresses") {
  for (const double poisson : {0.3, 0.49}) {
    const Material material{1000, poisson};
    const double fine = beam(4).force(material, Elements::quadratic, 2);
    for (const int cells : {1, 2}) {
      const double linear = beam(cells).force(material, Elements::linear, 2) / fine - 1,
                   quadratic = beam(cells).force(material, Elements::quadratic, 2) / fine - 1;
      MESSAGE("nu = ", poisson, ", ", cells, " cells: linear ", linear, ", quadratic ", quadratic);
      CHECK(std::abs(quadratic) < linear / 20);
    }
    // both ends held against turning: 12 E I / L^3 = 1, less by Timoshenko's shear, 12 E I / (5/6 G A L^2)
    const double shear = 12.0 / 12 * 1000 / (5.0 / 6 * 1000 / (2 * (1 + poisson)) * 100);
    CHECK(fine == doctest::Approx(1 / (1 + shear)).epsilon(0.05));
  }
}

TEST_CASE("quadratic elements: a pressed block, against a mesh three times finer") {
  for (const double poisson : {0.3, 0.45, 0.49}) {
    const Material material{1, poisson};
    const Body coarse = block(1), fine = block(3);
    for (const int axis : {0, 2}) {
      const double truth = fine.force(material, Elements::quadratic, axis),
                   linear = coarse.force(material, Elements::linear, axis) / truth - 1,
                   quadratic = coarse.force(material, Elements::quadratic, axis) / truth - 1;
      MESSAGE("nu = ", poisson, ", axis ", axis, ": linear ", linear, ", quadratic ", quadratic);
      CHECK(quadratic > 0);
      CHECK(quadratic < linear / 2);
    }
  }
}

}  // namespace
}  // namespace greenloop::offline
