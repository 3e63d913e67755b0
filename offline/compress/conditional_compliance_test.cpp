#include "offline/compress/conditional_compliance.hpp"

#include <doctest/doctest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <random>
#include <stdexcept>

#include "offline/compress/scale.hpp"

namespace greenloop::offline {
namespace {

Eigen::MatrixXd spd(std::size_t coefficients, double off_diagonal) {
  std::mt19937_64 random(7);
  const auto size = static_cast<Eigen::Index>(3 * coefficients);
  Eigen::MatrixXd a(size, size);
  for (auto& value : a.reshaped()) value = static_cast<double>(random() >> 11) * 0x1p-53 - 0.5;
  const Eigen::MatrixXd symmetric = a * a.transpose() / static_cast<double>(size);
  return 1e-3 * (off_diagonal * symmetric + 0.02 * Eigen::MatrixXd::Identity(size, size));
}

Eigen::Matrix3d block(const Eigen::MatrixXd& matrix, std::size_t i, std::size_t j) {
  return matrix.block<3, 3>(static_cast<Eigen::Index>(3 * i), static_cast<Eigen::Index>(3 * j));
}

DenseCompliance dense(const Eigen::MatrixXd& matrix) {
  DenseCompliance result(static_cast<std::size_t>(matrix.rows()) / 3);
  for (std::size_t j = 0; j < result.rows(); ++j) {
    for (std::size_t i = 0; i < result.rows(); ++i) {
      Eigen::Map<Eigen::Matrix3f>(result.column(j) + 9 * i) = block(matrix, i, j).cast<float>();
    }
  }
  return result;
}

struct Neighbours {
  std::vector<Eigen::Matrix3d> diagonal;
  CouplingCandidates couplings;
};

// scaled by the roots of the diagonal blocks
Neighbours neighbours(const Eigen::MatrixXd& matrix, double floor = 0) {
  Neighbours result;
  result.couplings.rows = static_cast<std::size_t>(matrix.rows()) / 3;
  std::vector<CoefficientScale> scales;
  for (std::size_t j = 0; j < result.couplings.rows; ++j) {
    result.diagonal.push_back(block(matrix, j, j));
    scales.emplace_back(block(matrix, j, j), block(matrix, j, j), "test", j);
    for (std::size_t i = 0; i < j; ++i) {
      const Eigen::Matrix3d scaled = scales[i].inverse() * block(matrix, i, j) * scales[j].inverse();
      const double norm = scaled.norm() / std::sqrt(3.0);
      if (norm < floor) continue;
      result.couplings.row.push_back(static_cast<std::uint32_t>(i));
      result.couplings.norm.push_back(static_cast<float>(norm));
      for (int k = 0; k < 9; ++k) result.couplings.value.push_back(static_cast<float>(scaled.data()[k]));
    }
    result.couplings.begin.push_back(result.couplings.row.size());
  }
  return result;
}

double least_eigenvalue(const Eigen::Matrix3d& matrix) {
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(0.5 * (matrix + matrix.transpose())).eigenvalues().minCoeff();
}

TEST_CASE("given all others: the inverse of the inverse's diagonal blocks") {
  const Eigen::MatrixXd matrix = spd(40, 1), inverse = matrix.inverse();
  const auto found = conditional_compliance(dense(matrix));
  REQUIRE(found.size() == 40);
  for (std::size_t i = 0; i < found.size(); ++i) {
    const Eigen::Matrix3d expected = block(inverse, i, i).inverse();
    CHECK((found[i] - expected).norm() < 1e-4 * expected.norm());
    CHECK(expected.norm() < 0.7 * block(matrix, i, i).norm());
  }
}

TEST_CASE("given the neighbours: the same where there are no more than 24") {
  for (const std::size_t count : {std::size_t{1}, std::size_t{2}, std::size_t{25}}) {
    CAPTURE(count);
    const Eigen::MatrixXd matrix = spd(count, 1);
    const auto [diagonal, couplings] = neighbours(matrix);
    const auto few = conditional_compliance(diagonal, couplings), all = conditional_compliance(dense(matrix));
    REQUIRE(few.size() == count);
    for (std::size_t i = 0; i < count; ++i) CHECK((few[i] - all[i]).norm() < 1e-4 * all[i].norm());
  }
}

TEST_CASE("given the neighbours, when there are more: between that given all and the diagonal block") {
  const Eigen::MatrixXd matrix = spd(60, 1);
  const auto [diagonal, couplings] = neighbours(matrix);
  const auto few = conditional_compliance(diagonal, couplings), all = conditional_compliance(dense(matrix));
  for (std::size_t i = 0; i < few.size(); ++i) {
    const double small = 1e-5 * diagonal[i].norm();
    CHECK(least_eigenvalue(few[i] - all[i]) > -small);
    CHECK(least_eigenvalue(diagonal[i] - few[i]) > -small);
    CHECK((few[i] - all[i]).norm() > small);
    CHECK((diagonal[i] - few[i]).norm() > 0.1 * diagonal[i].norm());
  }
}

TEST_CASE("the strongest neighbours count") {
  // coefficient 0 is coupled to 30 others, strongly to the last 24 only
  constexpr Eigen::Index size = 93;
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(size, size);
  for (Eigen::Index j = 1; j < 31; ++j) {
    const double coupling = j < 7 ? 0.05 : 0.15;
    for (Eigen::Index k = 0; k < 3; ++k) matrix(k, 3 * j + k) = matrix(3 * j + k, k) = coupling;
  }
  const auto [diagonal, couplings] = neighbours(matrix);
  const auto found = conditional_compliance(diagonal, couplings);
  CHECK((found[0] - (1 - 24 * 0.15 * 0.15) * Eigen::Matrix3d::Identity()).norm() < 1e-5);
}

TEST_CASE("where candidates are indefinite for what they lack, fewer neighbours or none are held") {
  // three that pull on each other more than a positive definite matrix could
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(9, 9);
  const auto couple = [&](Eigen::Index i, Eigen::Index j, double value) {
    for (Eigen::Index k = 0; k < 3; ++k) matrix(3 * i + k, 3 * j + k) = matrix(3 * j + k, 3 * i + k) = value;
  };
  couple(0, 1, 0.9);
  couple(0, 2, 0.8);
  const auto one = neighbours(matrix);
  const auto found = conditional_compliance(one.diagonal, one.couplings);
  CHECK((found[0] - (1 - 0.81) * Eigen::Matrix3d::Identity()).norm() < 1e-5);  // the stronger alone
  CHECK((found[1] - (1 - 0.81) * Eigen::Matrix3d::Identity()).norm() < 1e-5);

  couple(0, 1, 1.5);
  couple(0, 2, 1.4);
  const auto none = neighbours(matrix);
  for (const auto& conditional : conditional_compliance(none.diagonal, none.couplings)) {
    CHECK((conditional - Eigen::Matrix3d::Identity()).norm() < 1e-12);
  }
}

TEST_CASE("a compliance that is not positive definite is refused") {
  Eigen::MatrixXd matrix = spd(5, 1);
  matrix(4, 4) = -1e-3;
  CHECK_THROWS_AS((void)conditional_compliance(dense(matrix)), std::invalid_argument);
}

}  // namespace
}  // namespace greenloop::offline
