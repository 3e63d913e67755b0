#include "runtime/lu.hpp"

#include <doctest/doctest.h>

#include <Eigen/LU>
#include <limits>
#include <random>
#include <vector>

namespace {

using greenloop::Float4;

struct Problem {
  explicit Problem(std::uint32_t size)
      : order(size), a(std::size_t{stride()} * stride() / 4), exchange(stride()), b(stride() / 4) {}
  [[nodiscard]] std::uint32_t stride() const { return greenloop::lu_padded(order); }
  float& at(std::uint32_t i, std::uint32_t j) { return reinterpret_cast<float*>(a.data())[i + j * stride()]; }
  float& right(std::uint32_t i) { return reinterpret_cast<float*>(b.data())[i]; }

  std::uint32_t order;
  std::vector<Float4> a;
  std::vector<std::uint32_t> exchange;
  std::vector<Float4> b;
};

float uniform(std::mt19937_64& random) { return static_cast<float>(random() >> 40) * 0x1p-23F - 1.0F; }

TEST_CASE("lu solves random systems of every padding to float precision") {
  std::mt19937_64 random(1);
  for (std::uint32_t order = 1; order <= 50; ++order) {
    CAPTURE(order);
    Problem problem(order);
    Eigen::MatrixXd a(order, order);
    Eigen::VectorXd b(order);
    for (std::uint32_t j = 0; j < order; ++j) {
      for (std::uint32_t i = 0; i < order; ++i) {
        a(i, j) = problem.at(i, j) = uniform(random);
      }
      b(j) = problem.right(j) = uniform(random);
    }
    REQUIRE(greenloop::lu_factor(order, problem.a.data(), problem.exchange.data()));
    greenloop::lu_solve(order, problem.a.data(), problem.exchange.data(), problem.b.data());
    Eigen::VectorXd x(order);
    for (std::uint32_t i = 0; i < order; ++i) {
      x(i) = problem.right(i);
    }
    // backward stable: the residual is small against |A||x| whatever the condition; growth is at most a few here
    const double residual = (a * x - b).cwiseAbs().maxCoeff();
    const double scale = a.cwiseAbs().rowwise().sum().maxCoeff() * x.cwiseAbs().maxCoeff();
    CHECK(residual <= 4.0 * order * double{std::numeric_limits<float>::epsilon()} * scale);
  }
}

TEST_CASE("lu pivots: a zero on the diagonal is no obstacle") {
  Problem problem(2);
  problem.at(0, 1) = 2;
  problem.at(1, 0) = 4;
  problem.right(0) = 6;
  problem.right(1) = 8;
  REQUIRE(greenloop::lu_factor(2, problem.a.data(), problem.exchange.data()));
  greenloop::lu_solve(2, problem.a.data(), problem.exchange.data(), problem.b.data());
  CHECK(problem.right(0) == 2);
  CHECK(problem.right(1) == 3);
}

TEST_CASE("lu refuses singular matrices and those with NaN or infinity") {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  for (const float last : {1.0F, nan, infinity}) {
    Problem problem(3);
    for (std::uint32_t j = 0; j < 3; ++j) {
      for (std::uint32_t i = 0; i < 3; ++i) {
        problem.at(i, j) = static_cast<float>((i + 1) * (j + 1));
      }
    }
    problem.at(2, 2) = last == 1.0F ? 9.0F : last;
    CHECK_FALSE(greenloop::lu_factor(3, problem.a.data(), problem.exchange.data()));
  }
  Problem zero(6);
  CHECK_FALSE(greenloop::lu_factor(6, zero.a.data(), zero.exchange.data()));
}

}  // namespace
