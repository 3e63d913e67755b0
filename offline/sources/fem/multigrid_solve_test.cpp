#include <doctest/doctest.h>

#include <Eigen/Cholesky>
#include <Eigen/SparseCore>
#include <cmath>

#include "offline/multigrid/conjugate_gradients.hpp"
#include "offline/multigrid/hierarchy.hpp"
#include "offline/multigrid/prolongations.hpp"
#include "offline/sources/fem/block_matrices.hpp"
#include "offline/sources/fem/elasticity.hpp"
#include "offline/volume/testing/shapes.hpp"

namespace greenloop::offline {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;

TetrahedralMesh cube(int cells) { return testing::box(Eigen::Vector3i::Constant(cells), Vector3d::Ones()); }

using IsStiff = bool (*)(const Vector3d& point);

bool nowhere(const Vector3d&) { return false; }
bool in_ball(const Vector3d& p) { return (p - Vector3d(0.5, 0.5, 0.5)).norm() < 0.3; }
bool in_two_balls(const Vector3d& p) {
  return (p - Vector3d(0.27, 0.5, 0.5)).norm() < 0.2 || (p - Vector3d(0.71, 0.5, 0.5)).norm() < 0.21;
}
bool on_black(const Vector3d& p) {
  return (static_cast<int>(4 * p.x()) + static_cast<int>(4 * p.y()) + static_cast<int>(4 * p.z())) % 2 != 0;
}

/// A cube held at x = 0 under its weight.
struct Problem {
  TetrahedralMesh mesh;
  FreeVertices free;
  SolidMatter matter;

  Problem(int cells, IsStiff is_stiff, double contrast, const Material& soft = {1.0, 0.3})
      : mesh(cube(cells)),
        free(fixed(mesh)),
        matter{{{soft, 1000.0}, {{contrast * soft.young, soft.poisson}, 1000.0}}, {}} {
    for (const auto& t : mesh.tetrahedra) {
      Vector3d middle = Vector3d::Zero();
      for (const int v : t) middle += mesh.vertices[v] / 4.0;
      matter.kind.push_back(is_stiff(middle) ? 1 : 0);
    }
  }

  static std::vector<std::uint8_t> fixed(const TetrahedralMesh& mesh) {
    std::vector<std::uint8_t> result;
    for (const Vector3d& vertex : mesh.vertices) result.push_back(vertex.x() < 1e-9 ? 1 : 0);
    return result;
  }
};

std::vector<TetrahedralMesh> cubes(std::initializer_list<int> cells) {
  std::vector<TetrahedralMesh> result;
  for (const int each : cells) result.push_back(cube(each));
  return result;
}

BlockVector weight_of(const Problem& problem) {
  BlockVector b(static_cast<std::size_t>(problem.free.count));
  for (const auto& t : problem.mesh.tetrahedra) {
    for (const int v : t) {
      if (problem.free.number[v] >= 0) b[problem.free.number[v]][2] -= 1.0;
    }
  }
  return b;
}

Convergence solved(const Problem& problem, const std::vector<TetrahedralMesh>& coarser,
                   const std::vector<double>& interpolated_as, double mass = 0.0) {
  const BlockMatrix matrix = assemble_blocks(problem.mesh, problem.matter, problem.free, 1.0, mass);
  Hierarchy hierarchy(matrix, prolongations(problem.mesh, problem.free, interpolated_as, coarser));
  BlockVector x(matrix.rows());
  const BlockVector b = weight_of(problem);
  const Convergence found = conjugate_gradients(
      matrix, [&](std::span<const Double4> r, std::span<Double4> z) { hierarchy.cycle(r, z); }, b, x, 1e-5, 300);
  // what it says is so
  BlockVector r(matrix.rows());
  residual(matrix, b, x, r);
  CHECK(found.residual == doctest::Approx(std::sqrt(dot(r, r) / dot(b, b))));
  CHECK(found.reached == (found.residual <= 1e-5));
  return found;
}

int iterations(const Problem& problem, const std::vector<TetrahedralMesh>& coarser, double mass = 0.0) {
  const Convergence found = solved(problem, coarser, problem.matter.young(), mass);
  CHECK(found.reached);
  return found.iterations;
}

MatrixXd dense(const BlockMatrix& matrix) {
  MatrixXd result(Index{3} * matrix.rows(), Index{3} * matrix.rows());
  BlockVector x(matrix.rows()), y(matrix.rows());
  for (Index j = 0; j < result.cols(); ++j) {
    x[j / 3][j % 3] = 1.0;
    (void)multiply(matrix, x, y);
    for (Index i = 0; i < result.rows(); ++i) result(i, j) = y[i / 3][i % 3];
    x[j / 3][j % 3] = 0.0;
  }
  return result;
}

TEST_CASE("blocks are the stiffness and the mass of the same body") {
  const Problem problem(3, nowhere, 1.0, {2.5, 0.4});
  const MatrixXd lower(assemble_stiffness(problem.mesh, problem.matter.kinds[0].material, problem.free));
  const MatrixXd expected = lower.selfadjointView<Eigen::Lower>();
  CHECK((dense(assemble_blocks(problem.mesh, problem.matter, problem.free, 1.0, 0.0)) - expected).norm() <=
        1e-13 * expected.norm());
  // all mass moves along with a uniform displacement of a free body
  const FreeVertices all(std::vector<std::uint8_t>(problem.mesh.vertices.size(), 0));
  const BlockMatrix mass = assemble_blocks(problem.mesh, problem.matter, all, 0.0, 1.0);
  const BlockVector ones(mass.rows(), Double4{1.0, 0.0, 0.0, 0.0});
  BlockVector y(mass.rows());
  CHECK(multiply(mass, ones, y) == doctest::Approx(1000.0));
}

TEST_CASE("matter that does not fit, or is none, is refused") {
  Problem problem(2, nowhere, 1.0);
  const auto refused = [&] {
    CHECK_THROWS_AS((void)assemble_blocks(problem.mesh, problem.matter, problem.free, 1.0, 0.0), std::invalid_argument);
  };
  problem.matter.kinds[0].density = -1.0;
  refused();
  problem.matter.kinds[0] = {{1.0, 0.5}, 1.0};
  refused();
  problem.matter.kinds[0] = {{1.0, 0.3}, 1.0};
  problem.matter.kind.pop_back();
  refused();
}

TEST_CASE("a cycle is symmetric and positive definite") {
  const Problem problem(4, in_ball, 100.0);
  const BlockMatrix matrix = assemble_blocks(problem.mesh, problem.matter, problem.free, 1.0, 0.0);
  Hierarchy hierarchy(matrix, prolongations(problem.mesh, problem.free, problem.matter.young(), cubes({2, 1})));
  const Index n = Index{3} * matrix.rows();
  MatrixXd cycle(n, n);
  BlockVector r(matrix.rows()), z(matrix.rows());
  for (Index j = 0; j < n; ++j) {
    r[j / 3][j % 3] = 1.0;
    hierarchy.cycle(r, z);
    for (Index i = 0; i < n; ++i) cycle(i, j) = z[i / 3][i % 3];
    r[j / 3][j % 3] = 0.0;
  }
  CHECK((cycle - cycle.transpose()).norm() <= 1e-5 * cycle.norm());
  CHECK(Eigen::LLT<MatrixXd>(cycle).info() == Eigen::Success);
}

TEST_CASE("stiff parts cost a few iterations, wherever they lie") {
  CHECK(iterations(Problem(12, nowhere, 1.0), cubes({6, 3})) <= 14);
  for (const auto& coarser : {cubes({6, 3}), cubes({7, 3})}) {
    CHECK(iterations(Problem(12, in_ball, 1e6), coarser) <= 22);
    CHECK(iterations(Problem(12, in_two_balls, 1e6), coarser) <= 26);
    CHECK(iterations(Problem(12, on_black, 1e6), coarser) <= 26);
  }
}

TEST_CASE("interpolation that knows nothing of stiff parts stagnates on them") {
  const Problem ball(12, in_ball, 1e6);
  const std::vector<double> alike(ball.mesh.tetrahedra.size(), 1.0);
  CHECK(solved(ball, cubes({6, 3}), alike).iterations > 60);
}

TEST_CASE("iterations depend neither on Young's modulus nor on the time step") {
  const auto coarser = cubes({4, 2});
  const int at_rest = iterations(Problem(8, nowhere, 1.0), coarser);
  for (const double young : {1e3, 1e6, 1e10}) {
    const Problem problem(8, nowhere, 1.0, {young, 0.3});
    CHECK(std::abs(iterations(problem, coarser) - at_rest) <= 1);
    // 4/dt^2; short steps leave less to do
    for (const double step : {1e-3, 0.03, 1.0}) CHECK(iterations(problem, coarser, 4.0 / (step * step)) <= at_rest + 1);
  }
}

TEST_CASE("bodies that hardly yield in volume take longer") {
  CHECK(iterations(Problem(8, nowhere, 1.0, {1.0, 0.499}), cubes({4, 2})) <= 100);
}

TEST_CASE("what double precision cannot reach is no success") {
  const Convergence found = [] {
    const Problem problem(8, in_ball, 1e13);
    return solved(problem, cubes({4, 2}), problem.matter.young());
  }();
  CHECK(!found.reached);
  CHECK(found.residual > 1e-5);
}

TEST_CASE("the direct solution is found, from a start that is none") {
  const Problem problem(4, in_ball, 1e3);
  const BlockMatrix matrix = assemble_blocks(problem.mesh, problem.matter, problem.free, 1.0, 0.0);
  Hierarchy hierarchy(matrix, prolongations(problem.mesh, problem.free, problem.matter.young(), cubes({2})));
  const BlockVector b = weight_of(problem);
  BlockVector x(matrix.rows(), Double4{1.0, -2.0, 3.0, 0.0});
  const auto found = conjugate_gradients(
      matrix, [&](std::span<const Double4> r, std::span<Double4> z) { hierarchy.cycle(r, z); }, b, x, 1e-10, 100);
  CHECK(found.reached);
  Eigen::VectorXd right(Index{3} * matrix.rows());
  for (Index i = 0; i < right.size(); ++i) right[i] = b[i / 3][i % 3];
  const Eigen::VectorXd expected = dense(matrix).llt().solve(right);
  double most = 0.0;
  for (Index i = 0; i < right.size(); ++i) most = std::max(most, std::abs(x[i / 3][i % 3] - expected[i]));
  CHECK(most <= 1e-7 * expected.cwiseAbs().maxCoeff());
}

}  // namespace
}  // namespace greenloop::offline
