#include "offline/compress/wavelet/conditional_compliance.hpp"

#include <doctest/doctest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <random>
#include <stdexcept>

#include "offline/compress/testing/test_body.hpp"
#include "offline/compress/wavelet/scale.hpp"

namespace greenloop::offline {
namespace {

template <unsigned N>
Eigen::MatrixXd spd(std::size_t coefficients, double off_diagonal) {
  std::mt19937_64 random(7);
  const Eigen::Index size = block_begin<N>(coefficients);
  Eigen::MatrixXd a(size, size);
  for (auto& value : a.reshaped()) value = static_cast<double>(random() >> 11) * 0x1p-53 - 0.5;
  const Eigen::MatrixXd symmetric = a * a.transpose() / static_cast<double>(size);
  return 1e-3 * (off_diagonal * symmetric + 0.02 * Eigen::MatrixXd::Identity(size, size));
}

template <unsigned N>
SquareMatrix<N> block(const Eigen::MatrixXd& matrix, std::size_t i, std::size_t j) {
  return matrix.block<N, N>(block_begin<N>(i), block_begin<N>(j));
}

template <unsigned N>
struct Couplings {
  std::vector<SquareMatrix<N>> diagonal;
  std::vector<CouplingCandidates<N>> levels;
};

// on two levels; blocks of norm `floor` and more
template <unsigned N>
Couplings<N> couplings_of(const Eigen::MatrixXd& matrix, double floor = 0) {
  Couplings<N> result;
  result.levels.resize(2);
  const std::size_t count = static_cast<std::size_t>(matrix.rows()) / N;
  for (std::size_t j = 0; j < count; ++j) {
    auto& level = result.levels[j < count / 3 ? 0 : 1];
    result.diagonal.push_back(block<N>(matrix, j, j));
    for (std::size_t i = 0; i < j; ++i) {
      const SquareMatrix<N> value = block<N>(matrix, i, j);
      if (value.norm() < floor) continue;
      level.row.push_back(static_cast<std::uint32_t>(i));
      for (unsigned k = 0; k < N * N; ++k) level.value.push_back(static_cast<float>(value.data()[k]));
    }
    level.begin.push_back(level.row.size());
  }
  return result;
}

template <unsigned N>
std::vector<SquareMatrix<N>> conditional(const Eigen::MatrixXd& matrix) {
  const auto [diagonal, levels] = couplings_of<N>(matrix);
  return conditional_compliance<N>(diagonal, levels);
}

template <unsigned N>
SquareMatrix<N> given_all_others(const Eigen::MatrixXd& inverse, std::size_t i) {
  return block<N>(inverse, i, i).inverse();
}

double least_eigenvalue(const Eigen::MatrixXd& matrix) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(0.5 * (matrix + matrix.transpose())).eigenvalues().minCoeff();
}

TEST_CASE_TEMPLATE("where there are no more than 64 others, what the inverse says when all are held", T, test::Scalars,
                   test::Vectors) {
  constexpr unsigned N = T::value;
  for (const std::size_t count : {std::size_t{1}, std::size_t{2}, std::size_t{40}, std::size_t{65}}) {
    CAPTURE(count);
    const Eigen::MatrixXd matrix = spd<N>(count, 1), inverse = matrix.inverse();
    const auto found = conditional<N>(matrix);
    REQUIRE(found.size() == count);
    for (std::size_t i = 0; i < count; ++i) {
      const SquareMatrix<N> expected = given_all_others<N>(inverse, i);
      CHECK((found[i] - expected).norm() < 1e-4 * expected.norm());
      if (count > 2) CHECK(expected.norm() < 0.7 * block<N>(matrix, i, i).norm());
    }
  }
}

TEST_CASE_TEMPLATE("where there are more: between that and the diagonal block", T, test::Scalars, test::Vectors) {
  constexpr unsigned N = T::value;
  const Eigen::MatrixXd matrix = spd<N>(100, 1), inverse = matrix.inverse();
  const auto few = conditional<N>(matrix);
  for (std::size_t i = 0; i < few.size(); ++i) {
    const SquareMatrix<N> own = block<N>(matrix, i, i), all = given_all_others<N>(inverse, i);
    const double small = 1e-5 * own.norm();
    CHECK(least_eigenvalue(few[i] - all) > -small);
    CHECK(least_eigenvalue(own - few[i]) > -small);
    CHECK((few[i] - all).norm() > small);
    CHECK((own - few[i]).norm() > 0.1 * own.norm());
  }
}

TEST_CASE_TEMPLATE("the strongest neighbours count", T, test::Scalars, test::Vectors) {
  constexpr unsigned N = T::value;
  // coefficient 0 is coupled to 70 others, strongly to the last 64 only
  constexpr Eigen::Index n = N, size = 71 * n;
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(size, size);
  for (Eigen::Index j = 1; j < 71; ++j) {
    const double coupling = j < 7 ? 0.02 : 0.08;
    for (Eigen::Index k = 0; k < n; ++k) matrix(k, n * j + k) = matrix(n * j + k, k) = coupling;
  }
  CHECK((conditional<N>(matrix)[0] - (1 - 64 * 0.08 * 0.08) * SquareMatrix<N>::Identity()).norm() < 1e-5);
}

TEST_CASE_TEMPLATE("where candidates are indefinite for what they lack, fewer neighbours or none are held", T,
                   test::Scalars, test::Vectors) {
  constexpr unsigned N = T::value;
  constexpr Eigen::Index n = N;
  // three that pull on each other more than a positive definite matrix could
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(3 * n, 3 * n);
  const auto couple = [&](Eigen::Index i, Eigen::Index j, double value) {
    for (Eigen::Index k = 0; k < n; ++k) matrix(n * i + k, n * j + k) = matrix(n * j + k, n * i + k) = value;
  };
  couple(0, 1, 0.9);
  couple(0, 2, 0.8);
  const auto found = conditional<N>(matrix);
  CHECK((found[0] - (1 - 0.81) * SquareMatrix<N>::Identity()).norm() < 1e-5);  // the stronger alone
  CHECK((found[1] - (1 - 0.81) * SquareMatrix<N>::Identity()).norm() < 1e-5);

  couple(0, 1, 1.5);
  couple(0, 2, 1.4);
  for (const auto& none : conditional<N>(matrix)) CHECK((none - SquareMatrix<N>::Identity()).norm() < 1e-12);
}

TEST_CASE_TEMPLATE("a compliance that is not positive definite is refused", T, test::Scalars, test::Vectors) {
  constexpr unsigned N = T::value;
  Eigen::MatrixXd matrix = spd<N>(5, 1);
  matrix(N, N) = -1e-3;
  CHECK_THROWS_WITH_AS((void)conditional<N>(matrix), doctest::Contains("wavelet coefficient 1"), std::invalid_argument);
}

}  // namespace
}  // namespace greenloop::offline
