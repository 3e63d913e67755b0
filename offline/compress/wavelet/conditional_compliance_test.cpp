#include "offline/compress/wavelet/conditional_compliance.hpp"

#include <doctest/doctest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <random>
#include <stdexcept>

#include "offline/compress/wavelet/scale.hpp"

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

struct Couplings {
  std::vector<Eigen::Matrix3d> diagonal;
  std::vector<CouplingCandidates> levels;
};

// on two levels; blocks of norm `floor` and more
Couplings couplings_of(const Eigen::MatrixXd& matrix, double floor = 0) {
  Couplings result;
  result.levels.resize(2);
  const std::size_t count = static_cast<std::size_t>(matrix.rows()) / 3;
  for (std::size_t j = 0; j < count; ++j) {
    auto& level = result.levels[j < count / 3 ? 0 : 1];
    result.diagonal.push_back(block(matrix, j, j));
    for (std::size_t i = 0; i < j; ++i) {
      const Eigen::Matrix3d value = block(matrix, i, j);
      if (value.norm() < floor) continue;
      level.row.push_back(static_cast<std::uint32_t>(i));
      for (int k = 0; k < 9; ++k) level.value.push_back(static_cast<float>(value.data()[k]));
    }
    level.begin.push_back(level.row.size());
  }
  return result;
}

std::vector<Eigen::Matrix3d> conditional(const Eigen::MatrixXd& matrix) {
  const auto [diagonal, levels] = couplings_of(matrix);
  return conditional_compliance(diagonal, levels);
}

Eigen::Matrix3d given_all_others(const Eigen::MatrixXd& inverse, std::size_t i) {
  return block(inverse, i, i).inverse();
}

double least_eigenvalue(const Eigen::Matrix3d& matrix) {
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(0.5 * (matrix + matrix.transpose())).eigenvalues().minCoeff();
}

TEST_CASE("where there are no more than 64 others, what the inverse says when all are held") {
  for (const std::size_t count : {std::size_t{1}, std::size_t{2}, std::size_t{40}, std::size_t{65}}) {
    CAPTURE(count);
    const Eigen::MatrixXd matrix = spd(count, 1), inverse = matrix.inverse();
    const auto found = conditional(matrix);
    REQUIRE(found.size() == count);
    for (std::size_t i = 0; i < count; ++i) {
      const Eigen::Matrix3d expected = given_all_others(inverse, i);
      CHECK((found[i] - expected).norm() < 1e-4 * expected.norm());
      if (count > 2) CHECK(expected.norm() < 0.7 * block(matrix, i, i).norm());
    }
  }
}

TEST_CASE("where there are more: between that and the diagonal block") {
  const Eigen::MatrixXd matrix = spd(100, 1), inverse = matrix.inverse();
  const auto few = conditional(matrix);
  for (std::size_t i = 0; i < few.size(); ++i) {
    const Eigen::Matrix3d own = block(matrix, i, i), all = given_all_others(inverse, i);
    const double small = 1e-5 * own.norm();
    CHECK(least_eigenvalue(few[i] - all) > -small);
    CHECK(least_eigenvalue(own - few[i]) > -small);
    CHECK((few[i] - all).norm() > small);
    CHECK((own - few[i]).norm() > 0.1 * own.norm());
  }
}

TEST_CASE("the strongest neighbours count") {
  // coefficient 0 is coupled to 70 others, strongly to the last 64 only
  constexpr Eigen::Index size = 213;
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(size, size);
  for (Eigen::Index j = 1; j < 71; ++j) {
    const double coupling = j < 7 ? 0.02 : 0.08;
    for (Eigen::Index k = 0; k < 3; ++k) matrix(k, 3 * j + k) = matrix(3 * j + k, k) = coupling;
  }
  CHECK((conditional(matrix)[0] - (1 - 64 * 0.08 * 0.08) * Eigen::Matrix3d::Identity()).norm() < 1e-5);
}

TEST_CASE("where candidates are indefinite for what they lack, fewer neighbours or none are held") {
  // three that pull on each other more than a positive definite matrix could
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(9, 9);
  const auto couple = [&](Eigen::Index i, Eigen::Index j, double value) {
    for (Eigen::Index k = 0; k < 3; ++k) matrix(3 * i + k, 3 * j + k) = matrix(3 * j + k, 3 * i + k) = value;
  };
  couple(0, 1, 0.9);
  couple(0, 2, 0.8);
  const auto found = conditional(matrix);
  CHECK((found[0] - (1 - 0.81) * Eigen::Matrix3d::Identity()).norm() < 1e-5);  // the stronger alone
  CHECK((found[1] - (1 - 0.81) * Eigen::Matrix3d::Identity()).norm() < 1e-5);

  couple(0, 1, 1.5);
  couple(0, 2, 1.4);
  for (const auto& none : conditional(matrix)) CHECK((none - Eigen::Matrix3d::Identity()).norm() < 1e-12);
}

TEST_CASE("a compliance that is not positive definite is refused") {
  Eigen::MatrixXd matrix = spd(5, 1);
  matrix(4, 4) = -1e-3;
  CHECK_THROWS_WITH_AS((void)conditional(matrix), doctest::Contains("wavelet coefficient 1"), std::invalid_argument);
}

}  // namespace
}  // namespace greenloop::offline
