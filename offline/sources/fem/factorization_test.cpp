#include "offline/sources/fem/factorization.hpp"

#include <doctest/doctest.h>

#include <Eigen/Cholesky>
#include <stdexcept>

#include "offline/sources/fem/elasticity.hpp"
#include "offline/volume/testing/shapes.hpp"

namespace greenloop::offline {
namespace {

using Eigen::MatrixXd;
using Eigen::SparseMatrix;

SparseMatrix<double> clamped_box() {
  const auto mesh = testing::box({4, 3, 2}, {2, 1.5, 1});
  std::vector<std::uint8_t> fixed;
  for (const auto& x : mesh.vertices) fixed.push_back(x.z() == 0.0 ? 1 : 0);
  return assemble_stiffness(mesh, {1.0, 0.3}, FreeVertices(fixed));
}

SparseMatrix<double> unit_columns(Eigen::Index size, int first, int count) {
  SparseMatrix<double> units(size, count);
  for (int c = 0; c < count; ++c) units.insert(first + c, c) = 1.0;
  return units;
}

TEST_CASE("solutions are those of a dense Cholesky factorisation, in blocks of any size") {
  const auto lower = clamped_box();
  const MatrixXd dense = MatrixXd(lower).selfadjointView<Eigen::Lower>();
  const MatrixXd inverse = dense.llt().solve(MatrixXd::Identity(dense.rows(), dense.cols()));
  for (const int block : {1, 3}) {
    Factorization factors(lower, block);
    CHECK(factors.factor_entries() >= lower.nonZeros());
    for (const int count : {1, 7, 40}) {
      MatrixXd solution;
      factors.solve(unit_columns(lower.rows(), 5, count), solution);
      CHECK((solution - inverse.middleCols(5, count)).norm() < 1e-12 * inverse.norm());
    }
  }
}

TEST_CASE("two factorisations of one matrix give the same bits") {
  const auto lower = clamped_box();
  MatrixXd first, second;
  Factorization(lower, 3).solve(unit_columns(lower.rows(), 0, 12), first);
  Factorization(lower, 3).solve(unit_columns(lower.rows(), 0, 12), second);
  CHECK(first == second);
}

TEST_CASE("a factorisation can be moved") {
  const auto lower = clamped_box();
  Factorization original(lower, 3);
  Factorization moved(std::move(original));
  MatrixXd solution;
  moved.solve(unit_columns(lower.rows(), 0, 1), solution);
  CHECK((MatrixXd(lower).selfadjointView<Eigen::Lower>() * solution)
            .isApprox(MatrixXd(unit_columns(lower.rows(), 0, 1)), 1e-12));
}

TEST_CASE("matrices that are not positive definite are refused in words") {
  SparseMatrix<double> indefinite(3, 3);
  for (int i = 0; i < 3; ++i) indefinite.insert(i, i) = i == 1 ? -1.0 : 1.0;
  CHECK_THROWS_WITH_AS(Factorization{indefinite}, doctest::Contains("not positive definite"), std::runtime_error);
  SparseMatrix<double> singular(3, 3);
  singular.insert(0, 0) = 1.0;
  singular.insert(1, 1) = 1.0;
  CHECK_THROWS_AS(Factorization{singular}, std::runtime_error);
  CHECK_THROWS_AS((Factorization{clamped_box(), 7}), std::invalid_argument);
}

}  // namespace
}  // namespace greenloop::offline
