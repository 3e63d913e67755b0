#include "runtime/cholesky.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <limits>
#include <random>
#include <vector>

namespace {

using greenloop::Float4;

struct Problem {
  explicit Problem(std::uint32_t size) : order(size), a(std::size_t{stride()} * stride() / 4), b(stride() / 4) {
    // what must not be read
    for (std::uint32_t j = 0; j < stride(); ++j) {
      for (std::uint32_t i = 0; i < stride(); ++i) {
        at(i, j) = std::numeric_limits<float>::quiet_NaN();
      }
    }
  }
  [[nodiscard]] std::uint32_t stride() const { return greenloop::padded_order(order); }
  float& at(std::uint32_t i, std::uint32_t j) { return reinterpret_cast<float*>(a.data())[i + j * stride()]; }
  float& right(std::uint32_t i) { return reinterpret_cast<float*>(b.data())[i]; }
  void set(const Eigen::MatrixXd& matrix) {
    for (std::uint32_t j = 0; j < order; ++j) {
      for (std::uint32_t i = j; i < order; ++i) {
        at(i, j) = static_cast<float>(matrix(i, j));
      }
    }
  }

  std::uint32_t order;
  std::vector<Float4> a;
  std::vector<Float4> b;
};

float uniform(std::mt19937_64& random) { return static_cast<float>(random() >> 40) * 0x1p-23F - 1.0F; }

TEST_CASE("cholesky solves random systems of every padding to float precision, from the lower triangle alone") {
  std::mt19937_64 random(1);
  for (std::uint32_t order = 1; order <= 50; ++order) {
    CAPTURE(order);
    Problem problem(order);
    Eigen::MatrixXd root(order, order);
    Eigen::VectorXd b(order);
    for (std::uint32_t j = 0; j < order; ++j) {
      for (std::uint32_t i = 0; i < order; ++i) {
        root(i, j) = uniform(random);
      }
      b(j) = problem.right(j) = uniform(random);
    }
    Eigen::MatrixXd a = root * root.transpose() + 0.1 * Eigen::MatrixXd::Identity(order, order);
    a = a.cast<float>().cast<double>().eval();
    problem.set(a);
    REQUIRE(greenloop::cholesky_factor(order, problem.a.data()));
    greenloop::cholesky_solve(order, problem.a.data(), problem.b.data());
    Eigen::VectorXd x(order);
    for (std::uint32_t i = 0; i < order; ++i) {
      x(i) = problem.right(i);
    }
    // backward stable: the residual is small against |A||x| whatever the condition
    const double residual = (a * x - b).cwiseAbs().maxCoeff();
    const double scale = a.cwiseAbs().rowwise().sum().maxCoeff() * x.cwiseAbs().maxCoeff();
    CHECK(residual <= 4.0 * order * double{std::numeric_limits<float>::epsilon()} * scale);
  }
}

TEST_CASE("cholesky refuses matrices that are not positive definite, and those with NaN or infinity") {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  for (const float last : {5.0F, 4.0F, -1.0F, nan, infinity}) {
    CAPTURE(last);
    Problem problem(3);
    Eigen::Matrix3d a;  // positive definite from a last entry above 5 on
    a << 1, 0, 1, 0, 1, 2, 1, 2, 6;
    problem.set(a);
    CHECK(greenloop::cholesky_factor(3, problem.a.data()));
    problem.set(a);
    problem.at(2, 2) = last;
    CHECK_FALSE(greenloop::cholesky_factor(3, problem.a.data()));
  }
  Problem singular(6);
  singular.set(Eigen::MatrixXd::Ones(6, 6));
  CHECK_FALSE(greenloop::cholesky_factor(6, singular.a.data()));
  Problem zero(6);
  zero.set(Eigen::MatrixXd::Zero(6, 6));
  CHECK_FALSE(greenloop::cholesky_factor(6, zero.a.data()));
}

}  // namespace
