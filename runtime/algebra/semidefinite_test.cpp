#include "runtime/algebra/semidefinite.hpp"

#include <doctest/doctest.h>

#include <Eigen/Dense>
#include <limits>
#include <random>
#include <vector>

namespace greenloop {
namespace {

using Eigen::Index;
using Eigen::MatrixXf;
using Eigen::VectorXf;

MatrixXf random_rows(Index rows, Index columns, unsigned seed) {
  std::mt19937_64 random(seed);
  return MatrixXf::NullaryExpr(rows, columns, [&] { return static_cast<float>(random() >> 40) * 0x1p-23F - 1.0F; });
}

struct Solved {
  std::uint32_t left_out;
  VectorXf x;
};

Solved solve(MatrixXf a, VectorXf b, float share) {
  std::vector<float> diagonal(static_cast<std::size_t>(a.rows()));
  const auto order = static_cast<std::uint32_t>(a.rows());
  const std::uint32_t left_out = factor_semidefinite(order, order, share, a.data(), diagonal.data());
  solve_semidefinite(order, order, a.data(), b.data());
  return {left_out, b};
}

TEST_CASE("a positive definite system is solved") {
  for (const Index order : {1, 2, 7, 30}) {
    const MatrixXf rows = random_rows(order, order + 5, 1);
    const MatrixXf a = rows * rows.transpose();
    const VectorXf x = random_rows(order, 1, 2);
    const Solved solved = solve(a, a * x, 0x1p-20F);
    CHECK(solved.left_out == 0);
    CHECK((solved.x - x).norm() <= 1e-3F * x.norm());
  }
}

TEST_CASE("rows that depend on those before them are left out, and the others are solved as without them") {
  MatrixXf rows = random_rows(6, 9, 3);
  rows.row(2) = 0.5F * rows.row(0) - rows.row(1);
  rows.row(5) = rows.row(4);
  const VectorXf b = random_rows(6, 1, 4);
  const Solved solved = solve(rows * rows.transpose(), b, 0x1p-10F);
  CHECK(solved.left_out == 2);
  CHECK(solved.x(2) == 0);
  CHECK(solved.x(5) == 0);
  MatrixXf kept(4, 9);
  kept << rows.row(0), rows.row(1), rows.row(3), rows.row(4);
  const VectorXf exact = (kept * kept.transpose()).ldlt().solve(VectorXf{{b(0), b(1), b(3), b(4)}});
  CHECK((VectorXf{{solved.x(0), solved.x(1), solved.x(3), solved.x(4)}} - exact).norm() <= 1e-4F * exact.norm());
}

TEST_CASE("what is zero, negative or no number is left out") {
  for (const float value :
       {0.0F, -1.0F, std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN(), 1e-45F}) {
    const MatrixXf a{{value, 0}, {0, 2}};
    const Solved solved = solve(a, VectorXf{{1, 4}}, 0x1p-20F);
    CHECK(solved.left_out == 1);
    CHECK(solved.x(0) == 0);
    CHECK(solved.x(1) == 2);
  }
}

}  // namespace
}  // namespace greenloop
