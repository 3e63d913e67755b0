#include "offline/reduce/streaming_basis.hpp"

#include <doctest/doctest.h>

#include <Eigen/QR>
#include <Eigen/SVD>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace greenloop::offline {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::MatrixXf;

MatrixXd noise(Index rows, Index columns, unsigned seed) {
  MatrixXd matrix(rows, columns);
  std::uint64_t state = seed;
  for (Index c = 0; c < columns; ++c) {
    for (Index r = 0; r < rows; ++r) {
      state = state * 6364136223846793005U + 1442695040888963407U;
      matrix(r, c) = static_cast<double>(state >> 40U) / static_cast<double>(1U << 24U) - 0.5;
    }
  }
  return matrix;
}

MatrixXd orthonormal(Index rows, Index columns, unsigned seed) {
  const Eigen::HouseholderQR<MatrixXd> qr(noise(rows, columns, seed));
  return qr.householderQ() * MatrixXd::Identity(rows, columns);
}

/// With singular values that fall by a factor each.
MatrixXf falling_matrix(Index rows, Index columns, Index rank, double factor) {
  Eigen::VectorXd sigma(rank);
  for (Index j = 0; j < rank; ++j) sigma[j] = 100 * std::pow(factor, static_cast<double>(j));
  return (orthonormal(rows, rank, 1) * sigma.asDiagonal() * orthonormal(columns, rank, 2).transpose()).cast<float>();
}

StreamingBasis streamed(const MatrixXf& matrix, double tolerance, Index most, Index block = 32) {
  StreamingBasis basis(matrix.rows(), matrix.cols(), tolerance, most);
  for (Index c = 0; c < matrix.cols(); c += block) {
    MatrixXf part = matrix.middleCols(c, std::min(block, matrix.cols() - c));
    basis.add(part);
  }
  return basis;
}

/// Largest difference to the singular values of a full decomposition, relative to the largest.
double singular_value_error(const MatrixXf& matrix, const StreamingBasis& basis) {
  const Eigen::VectorXd exact = Eigen::BDCSVD<MatrixXd>(matrix.cast<double>()).singularValues();
  const Eigen::VectorXd found = Eigen::BDCSVD<MatrixXd>(basis.coordinates()).singularValues();
  double worst = 0;
  for (Index j = 0; j < exact.size(); ++j) {
    worst = std::max(worst, std::abs(exact[j] - (j < found.size() ? found[j] : 0)));
  }
  return worst / exact[0];
}

double orthonormality(const StreamingBasis& basis) {
  const MatrixXd w = basis.basis().cast<double>();
  return (w.transpose() * w - MatrixXd::Identity(w.cols(), w.cols())).cwiseAbs().maxCoeff();
}

TEST_CASE("streaming basis: singular values are those of a full decomposition within the tolerance") {
  const MatrixXf matrix = falling_matrix(240, 300, 80, 0.8);
  for (const double tolerance : {1e-6, 1e-4, 1e-2}) {
    CAPTURE(tolerance);
    const StreamingBasis basis = streamed(matrix, tolerance, 200);
    CHECK(singular_value_error(matrix, basis) < std::max(tolerance, 1e-6));
    CHECK(orthonormality(basis) < 1e-5);
    CHECK(basis.modes() < 100);
  }
  CHECK(streamed(matrix, 1e-2, 200).modes() < streamed(matrix, 1e-6, 200).modes());
}

TEST_CASE("streaming basis: what is left out of each column is what it says") {
  const MatrixXf matrix = falling_matrix(200, 160, 60, 0.85);
  for (const Index most : {Index{150}, Index{60}}) {  // with the fewer, directions are given up meanwhile
    CAPTURE(most);
    const StreamingBasis basis = streamed(matrix, 0.05, most, 16);
    const MatrixXd left = matrix.cast<double>() - basis.basis().cast<double>() * basis.coordinates();
    for (Index c = 0; c < matrix.cols(); ++c) {
      CHECK(left.col(c).squaredNorm() == doctest::Approx(basis.dropped()[static_cast<std::size_t>(c)]).epsilon(1e-3));
    }
    CHECK(left.norm() <= 0.05 * 100);
  }
}

TEST_CASE("streaming basis: columns of nothing, and more modes than there is room for") {
  StreamingBasis basis(50, 40, 1e-3, 30);
  MatrixXf nothing = MatrixXf::Zero(50, 20);
  basis.add(nothing);
  CHECK(basis.modes() == 0);
  CHECK(basis.coordinates().cols() == 20);
  const MatrixXf rough = noise(100, 120, 3).cast<float>();
  CHECK_THROWS_AS((void)streamed(rough, 1e-3, 50, 16), std::runtime_error);
  CHECK_THROWS_AS(StreamingBasis(0, 1, 1e-3, 1), std::invalid_argument);
}

}  // namespace
}  // namespace greenloop::offline
