#include <doctest/doctest.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <cmath>
#include <random>

#include "offline/multigrid/conjugate_gradients.hpp"
#include "offline/multigrid/galerkin.hpp"
#include "offline/multigrid/hierarchy.hpp"
#include "offline/multigrid/prolongations.hpp"
#include "offline/multigrid/tetrahedron_grid.hpp"
#include "offline/volume/testing/shapes.hpp"

namespace greenloop::offline {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;

TetrahedralMesh cube(int cells) { return testing::box(Eigen::Vector3i::Constant(cells), Vector3d::Ones()); }

MatrixXd dense(const BlockMatrix& matrix) {
  MatrixXd result = MatrixXd::Zero(Index{3} * matrix.rows(), Index{3} * matrix.rows());
  const auto place = [&](std::uint32_t row, std::uint32_t column, const DoubleBlock& block) {
    for (int j = 0; j < 3; ++j) {
      for (int i = 0; i < 3; ++i) result(Index{3} * row + i, Index{3} * column + j) = block.column[j][i];
    }
  };
  for (std::uint32_t v = 0; v < matrix.rows(); ++v) {
    place(v, v, matrix.diagonal[v]);
    for (std::uint32_t k = matrix.start[v]; k < matrix.start[v + 1]; ++k) place(v, matrix.column[k], matrix.block[k]);
  }
  return result;
}

MatrixXd dense(const Prolongation& p) {
  MatrixXd result = MatrixXd::Zero(Index{3} * p.rows(), Index{3} * p.coarse);
  for (std::uint32_t v = 0; v < p.rows(); ++v) {
    for (std::uint32_t k = p.start[v]; k < p.start[v + 1]; ++k) {
      for (Index i = 0; i < 3; ++i) result(Index{3} * v + i, Index{3} * p.parent[k] + i) += p.weight[k];
    }
  }
  return result;
}

DoubleBlock block_of(const Eigen::Matrix3d& values) {
  DoubleBlock block;
  for (int j = 0; j < 3; ++j) block.column[j] = Double4{values(0, j), values(1, j), values(2, j), 0.0};
  return block;
}

/// Symmetric and positive definite, with blocks of no symmetry of their own where `joined` says so.
template <class Joined>
BlockMatrix random_matrix(std::uint32_t rows, const Joined& joined) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  MatrixXd full = MatrixXd::Zero(Index{3} * rows, Index{3} * rows);
  for (Index j = 0; j < full.cols(); ++j) {
    for (Index i = 0; i <= j; ++i) full(i, j) = full(j, i) = number(random);
    full(j, j) = 3.0 * rows;
  }
  BlockMatrix matrix;
  matrix.start.push_back(0);
  for (std::uint32_t v = 0; v < rows; ++v) {
    for (std::uint32_t w = 0; w < rows; ++w) {
      if (w == v) matrix.upper.push_back(static_cast<std::uint32_t>(matrix.column.size()));
      if (w == v || !joined(v, w)) continue;
      matrix.column.push_back(w);
      matrix.block.push_back(block_of(full.block<3, 3>(Index{3} * v, Index{3} * w)));
    }
    matrix.diagonal.push_back(block_of(full.block<3, 3>(Index{3} * v, Index{3} * v)));
    matrix.start.push_back(static_cast<std::uint32_t>(matrix.column.size()));
  }
  return matrix;
}

TEST_CASE("the coarse operator is P^T A P") {
  const BlockMatrix matrix =
      random_matrix(9, [](std::uint32_t v, std::uint32_t w) { return (v + w) % 3 != 0 || v + w == 9; });
  // rows of none, one and several parents, weights below 0
  const Prolongation p{{0, 0, 1, 3, 5, 6, 8, 11, 12, 13},
                       {0, 0, 1, 2, 1, 1, 0, 2, 0, 1, 2, 2, 0},
                       {1.0, 0.25, 0.75, 0.5, 0.5, 1.0, -0.5, 1.5, 0.2, 0.3, 0.5, 1.0, 0.7},
                       3};
  const MatrixXd expected = dense(p).transpose() * dense(matrix) * dense(p);
  const BlockMatrix coarse = galerkin(matrix, p);
  CHECK((dense(coarse) - expected).norm() <= 1e-14 * expected.norm());
  CHECK((dense(coarse) - dense(coarse).transpose()).norm() <= 1e-15 * expected.norm());
}

TEST_CASE("a grid finds the tetrahedron around a point, and outside that which needs least to be continued") {
  const TetrahedralMesh mesh = cube(3);
  const TetrahedronGrid grid(mesh);
  std::mt19937 random(2);
  std::uniform_real_distribution<double> number(-0.3, 1.3);
  int inside = 0;
  for (int i = 0; i < 300; ++i) {
    const Vector3d point(number(random), number(random), number(random));
    const Barycentric at = grid.nearest(point);
    Vector3d sum = Vector3d::Zero();
    for (Index a = 0; a < 4; ++a) sum += at.coordinate[a] * mesh.vertices[mesh.tetrahedra[at.tetrahedron][a]];
    CHECK((sum - point).norm() < 1e-12);
    CHECK(at.coordinate.sum() == doctest::Approx(1.0));
    const bool within = point.minCoeff() >= 0.0 && point.maxCoeff() <= 1.0;
    CHECK((at.least() >= -1e-9) == within);
    inside += within ? 1 : 0;
  }
  CHECK(inside > 50);
  CHECK(!grid.nearest({0.5, 0.5, 0.5}, 1, [](std::uint32_t) { return false; }));
}

TEST_CASE("interpolation is exact for linear displacements, also where meshes do not overlap") {
  TetrahedralMesh coarse = cube(2);
  for (Vector3d& vertex : coarse.vertices) vertex = 0.8 * vertex + Vector3d(0.15, 0.1, 0.05);
  const TetrahedralMesh fine = cube(5);
  const FreeVertices free(std::vector<std::uint8_t>(fine.vertices.size(), 0));
  const std::vector<double> young(fine.tetrahedra.size(), 1.0);
  const Prolongation p = prolongations(fine, free, young, {&coarse, 1}).front();
  REQUIRE(p.coarse == coarse.vertices.size());
  for (std::uint32_t v = 0; v < p.rows(); ++v) {
    Vector3d sum = Vector3d::Zero();
    for (std::uint32_t k = p.start[v]; k < p.start[v + 1]; ++k) sum += p.weight[k] * coarse.vertices[p.parent[k]];
    CHECK((sum - fine.vertices[v]).norm() < 1e-12);
  }
}

TEST_CASE("vertices hang on their own piece, which goes to a coarser level that has no room for it") {
  const TetrahedralMesh fine = cube(8);
  const FreeVertices free(std::vector<std::uint8_t>(fine.vertices.size(), 0));
  std::vector<double> young;
  std::vector<std::uint8_t> stiff(fine.vertices.size(), 0);
  for (const auto& t : fine.tetrahedra) {
    Vector3d middle = Vector3d::Zero();
    for (const int v : t) middle += fine.vertices[v] / 4.0;
    const bool within = (middle - Vector3d(0.3, 0.3, 0.3)).norm() < 0.17;
    young.push_back(within ? 1e6 : 1.0);
    for (const int v : t) {
      if (within) stiff[v] = 1;
    }
  }
  const TetrahedralMesh coarse = cube(1);
  const Prolongation p = prolongations(fine, free, young, {&coarse, 1}).front();
  const auto guests = p.coarse - static_cast<std::uint32_t>(coarse.vertices.size());
  CHECK(guests >= 4);
  int hung = 0;
  for (std::uint32_t v = 0; v < p.rows(); ++v) {
    for (std::uint32_t k = p.start[v]; k < p.start[v + 1]; ++k) {
      CHECK((p.parent[k] >= coarse.vertices.size()) == (stiff[v] != 0));
      hung += stiff[v];
    }
  }
  CHECK(hung > 20);
}

TEST_CASE("what cannot be a hierarchy is said") {
  const TetrahedralMesh fine = cube(2);
  const TetrahedralMesh coarse = cube(1);
  const std::vector<double> young(fine.tetrahedra.size(), 1.0);
  const FreeVertices none(std::vector<std::uint8_t>(fine.vertices.size(), 1));
  const FreeVertices all(std::vector<std::uint8_t>(fine.vertices.size(), 0));
  CHECK_THROWS_AS((void)prolongations(fine, none, young, {&coarse, 1}), std::invalid_argument);
  CHECK_THROWS_AS((void)prolongations(fine, all, {young.data(), 3}, {&coarse, 1}), std::invalid_argument);
  CHECK_THROWS_AS((void)TetrahedronGrid(TetrahedralMesh{}), std::invalid_argument);
  const BlockMatrix matrix = random_matrix(4, [](std::uint32_t, std::uint32_t) { return true; });
  CHECK_THROWS_AS((void)Hierarchy(matrix, prolongations(fine, all, young, {&coarse, 1})), std::invalid_argument);
}

}  // namespace
}  // namespace greenloop::offline
