#include "runtime/algebra/cholesky.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <bit>
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

// of the lower triangle, to the end of its padding
std::vector<std::uint32_t> lower_bits(std::uint32_t order, std::uint32_t stride, const std::vector<Float4>& a) {
  const auto* entry = reinterpret_cast<const float*>(a.data());
  std::vector<std::uint32_t> bits;
  for (std::uint32_t j = 0; j < order; ++j) {
    for (std::uint32_t i = j; i < greenloop::padded_order(order); ++i) {
      bits.push_back(std::bit_cast<std::uint32_t>(entry[i + std::size_t{j} * stride]));
    }
  }
  return bits;
}

float uniform(std::mt19937_64& random) { return static_cast<float>(random() >> 40) * 0x1p-23F - 1.0F; }

TEST_CASE(
    "cholesky solves random systems of every padding to float precision, from the lower triangle alone, on every "
    "processor with the same bits") {
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
    std::vector<Float4> fastest = problem.a;
    REQUIRE(greenloop::fastest_cholesky_factor()(order, problem.stride(), fastest.data()));
    REQUIRE(greenloop::cholesky_factor(order, problem.stride(), problem.a.data()));
    CHECK(lower_bits(order, problem.stride(), fastest) == lower_bits(order, problem.stride(), problem.a));
    greenloop::cholesky_solve(order, problem.stride(), problem.a.data(), problem.b.data());
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
    CHECK(greenloop::cholesky_factor(3, problem.stride(), problem.a.data()));
    problem.set(a);
    problem.at(2, 2) = last;
    CHECK_FALSE(greenloop::cholesky_factor(3, problem.stride(), problem.a.data()));
  }
  Problem singular(6);
  singular.set(Eigen::MatrixXd::Ones(6, 6));
  CHECK_FALSE(greenloop::cholesky_factor(6, singular.stride(), singular.a.data()));
  Problem zero(6);
  zero.set(Eigen::MatrixXd::Zero(6, 6));
  CHECK_FALSE(greenloop::cholesky_factor(6, zero.stride(), zero.a.data()));
}

// rows of a positive definite matrix of 3x3 blocks come and go; its factors follow
class Updated {
 public:
  Updated(std::uint32_t nodes, std::uint64_t seed) : random_(seed), a_(3 * nodes, 3 * nodes) {
    Eigen::MatrixXd root(3 * nodes, 3 * nodes);
    for (Eigen::Index k = 0; k < root.size(); ++k) {
      root.data()[k] = uniform(random_);
    }
    a_ = root * root.transpose() / (3.0 * nodes) + 0.1 * Eigen::MatrixXd::Identity(3 * nodes, 3 * nodes);
    a_ = a_.cast<float>().cast<double>().eval();
    for (std::uint32_t node = 0; node < nodes; ++node) {
      outside_.push_back(node);
    }
    stride_ = greenloop::padded_order(3 * nodes);
    factors_.assign(std::size_t{stride_} * stride_ / 4, greenloop::splat(std::numeric_limits<float>::quiet_NaN()));
    scratch_.resize(std::size_t{3} * stride_ / 4);
  }

  [[nodiscard]] std::uint32_t order() const { return static_cast<std::uint32_t>(3 * inside_.size()); }
  [[nodiscard]] std::size_t inside() const { return inside_.size(); }

  bool append() {
    const std::uint32_t node = take(outside_);
    inside_.push_back(node);
    auto* border = reinterpret_cast<float*>(scratch_.data());
    for (std::uint32_t r = 0; r < 3; ++r) {
      for (std::uint32_t k = 0; k < order() - 3 + r + 1; ++k) {
        border[r * stride_ + k] = static_cast<float>(a_(3 * node + r, 3 * inside_[k / 3] + k % 3));
      }
    }
    return greenloop::cholesky_append(order() - 3, 3, stride_, factors_.data(), scratch_.data());
  }

  void remove() {
    const std::uint32_t before = order();
    const std::size_t at = random_() % inside_.size();
    outside_.push_back(inside_[at]);
    inside_.erase(inside_.begin() + static_cast<std::ptrdiff_t>(at));
    greenloop::cholesky_remove(before, static_cast<std::uint32_t>(3 * at), 3, stride_, factors_.data(),
                               scratch_.data());
  }

  // ||L D L^T - A|| / ||A|| of what is inside now
  [[nodiscard]] double error() const {
    const Eigen::Index n = order();
    Eigen::MatrixXd lower = Eigen::MatrixXd::Identity(n, n), exact(n, n);
    Eigen::VectorXd pivots(n);
    const auto* entry = reinterpret_cast<const float*>(factors_.data());
    for (Eigen::Index j = 0; j < n; ++j) {
      pivots(j) = 1 / double{entry[j * stride_ + j]};
      for (Eigen::Index i = 0; i < n; ++i) {
        exact(i, j) = a_(3 * inside_[static_cast<std::size_t>(i / 3)] + i % 3,
                         3 * inside_[static_cast<std::size_t>(j / 3)] + j % 3);
        if (i > j) {
          lower(i, j) = double{entry[j * stride_ + i]};
        }
      }
    }
    return (lower * pivots.asDiagonal() * lower.transpose() - exact).norm() / exact.norm();
  }

 private:
  std::uint32_t take(std::vector<std::uint32_t>& from) {
    std::swap(from[random_() % from.size()], from.back());
    const std::uint32_t node = from.back();
    from.pop_back();
    return node;
  }

  std::mt19937_64 random_;
  Eigen::MatrixXd a_;
  std::vector<std::uint32_t> inside_, outside_;
  std::uint32_t stride_ = 0;
  std::vector<Float4> factors_, scratch_;
};

TEST_CASE("factors follow rows that are appended and removed, at every place and padding") {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    CAPTURE(seed);
    Updated matrix(11, seed);
    std::mt19937_64 random(seed);
    for (int step = 0; step < 100; ++step) {
      if (matrix.inside() == 0 || (matrix.inside() < 11 && random() % 2 == 0)) {
        REQUIRE(matrix.append());
      } else {
        matrix.remove();
      }
      CHECK((matrix.inside() == 0 || matrix.error() <= 1e-6));
    }
  }
}

TEST_CASE("factors do not drift in a hundred thousand updates") {
  Updated matrix(12, 3);
  while (matrix.inside() < 6) {
    REQUIRE(matrix.append());
  }
  for (int step = 0; step < 50000; ++step) {
    matrix.remove();
    REQUIRE(matrix.append());
  }
  MESSAGE("error after 100,000 updates: ", matrix.error());
  CHECK(matrix.error() <= 2e-6);
}

TEST_CASE("append refuses what is not positive definite") {
  Problem problem(4);
  problem.set(Eigen::MatrixXd::Identity(4, 4));
  REQUIRE(greenloop::cholesky_factor(3, problem.stride(), problem.a.data()));
  for (const float last : {1.0F, 0.5F, -1.0F, std::numeric_limits<float>::quiet_NaN()}) {
    std::vector<Float4> border = {Float4{1, 0, 0, last}};  // the Schur complement is last - 1
    CHECK_FALSE(greenloop::cholesky_append(3, 1, problem.stride(), problem.a.data(), border.data()));
  }
  std::vector<Float4> border = {Float4{1, 0, 0, 1.5F}};
  CHECK(greenloop::cholesky_append(3, 1, problem.stride(), problem.a.data(), border.data()));
}

}  // namespace
