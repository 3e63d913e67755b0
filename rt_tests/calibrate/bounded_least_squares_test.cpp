#include "rt_tests/calibrate/bounded_least_squares.hpp"

#include <doctest/doctest.h>

#include <Eigen/Cholesky>
#include <random>
#include <stdexcept>

namespace greenloop {
namespace {

Eigen::VectorXd solve(const Eigen::MatrixXd& a, const Eigen::VectorXd& y, const Eigen::VectorXd& lower) {
  return bounded_least_squares(a.transpose() * a, a.transpose() * y, lower);
}

Eigen::MatrixXd random_matrix(std::mt19937& random, Eigen::Index rows, Eigen::Index columns) {
  std::normal_distribution<double> normal;
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); });
}

TEST_CASE("where no bound is met it is the plain solution") {
  std::mt19937 random(1);
  const Eigen::MatrixXd a = random_matrix(random, 40, 12);
  const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(12, 1, 3);
  CHECK((solve(a, a * x, Eigen::VectorXd::Zero(12)) - x).norm() < 1e-9);
}

TEST_CASE("a component beyond its bound stands at it, and the others make up for it") {
  const Eigen::Vector3d y(1, -2, 3);
  const Eigen::MatrixXd one = Eigen::Matrix3d::Identity();
  CHECK((solve(one, y, Eigen::Vector3d::Zero()) - Eigen::Vector3d(1, 0, 3)).norm() < 1e-12);
  CHECK((solve(one, y, Eigen::Vector3d(2, -1, 0)) - Eigen::Vector3d(2, -1, 3)).norm() < 1e-12);
  // without bounds (3, -1): with the second at 0 the first is 2, not 3
  const Eigen::MatrixXd a = (Eigen::Matrix2d() << 1, 1, 0, 1).finished();
  const Eigen::VectorXd x = solve(a, Eigen::Vector2d(2, -1), Eigen::Vector2d::Zero());
  CHECK((x - Eigen::Vector2d(2, 0)).norm() < 1e-12);
}

TEST_CASE("no direction within the bounds lowers the sum of squares") {
  std::mt19937 random(2);
  for (int problem = 0; problem < 200; ++problem) {
    const Eigen::MatrixXd a = random_matrix(random, 60, 30);
    const Eigen::VectorXd y = random_matrix(random, 60, 1), lower = 0.01 * random_matrix(random, 30, 1);
    const Eigen::VectorXd x = solve(a, y, lower), slope = a.transpose() * (a * x - y);
    CAPTURE(problem);
    CHECK((x - lower).minCoeff() >= 0);
    CHECK(slope.minCoeff() > -1e-8);
    CHECK((x - lower).cwiseProduct(slope).cwiseAbs().maxCoeff() < 1e-8);
    CHECK((x - lower).maxCoeff() > 0);
    CHECK((x - lower).minCoeff() == 0);
  }
}

TEST_CASE("columns that are equal, sums of others or zero do no harm") {
  std::mt19937 random(3);
  Eigen::MatrixXd a = random_matrix(random, 40, 8);
  a.col(3) = a.col(1);
  a.col(5) = a.col(0) + 2 * a.col(2);
  a.col(7).setZero();
  const Eigen::VectorXd y = a * Eigen::VectorXd::LinSpaced(8, 1, 2);
  Eigen::VectorXd lower = Eigen::VectorXd::Zero(8);
  lower[7] = 0.5;
  const Eigen::VectorXd x = solve(a, y, lower);
  CHECK((a * x - y).norm() < 1e-7);
  CHECK((x - lower).minCoeff() >= 0);
  CHECK(x[7] == 0.5);
}

TEST_CASE("sizes that differ are refused") {
  const Eigen::MatrixXd gram = Eigen::MatrixXd::Identity(3, 3);
  const Eigen::VectorXd two = Eigen::VectorXd::Ones(2), three = Eigen::VectorXd::Ones(3);
  CHECK_THROWS_AS(static_cast<void>(bounded_least_squares(gram, two, three)), std::invalid_argument);
  CHECK_THROWS_AS(static_cast<void>(bounded_least_squares(gram, three, two)), std::invalid_argument);
}

}  // namespace
}  // namespace greenloop
