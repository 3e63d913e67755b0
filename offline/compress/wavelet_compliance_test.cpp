#include "offline/compress/compliance_pyramid.hpp"

#include <doctest/doctest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "offline/compress/dense_reference.hpp"

namespace greenloop::offline {
namespace {

const test::Body& body() {
  static const test::Body value = test::make_body(3);
  return value;
}

LinearWavelet wavelet_of(const test::Body& b, bool lifted) { return {b.mesh, b.flags, b.area, lifted}; }

CompliancePyramid pyramid_of(bool lifted, double floor) {
  return build_pyramid(wavelet_of(body(), lifted), test::columns_of(body().compliance), floor, {});
}

Eigen::Matrix3d block(const Eigen::MatrixXd& matrix, std::size_t i, std::size_t j) {
  return matrix.block<3, 3>(static_cast<Eigen::Index>(3 * i), static_cast<Eigen::Index>(3 * j));
}

// candidates with the scales taken out again: rows x columns, m/N
Eigen::MatrixXd unscaled(const CouplingCandidates& candidates, const CoefficientScale* rows,
                         const CoefficientScale* columns) {
  const std::size_t count = candidates.begin.size() - 1;
  Eigen::MatrixXd matrix =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(3 * candidates.rows), static_cast<Eigen::Index>(3 * count));
  for (std::size_t j = 0; j < count; ++j) {
    for (std::size_t b = candidates.begin[j]; b < candidates.begin[j + 1]; ++b) {
      const std::size_t i = candidates.row[b];
      const Eigen::Matrix3d value = Eigen::Map<const Eigen::Matrix3f>(candidates.value.data() + 9 * b).cast<double>();
      CHECK(static_cast<double>(candidates.norm[b]) == doctest::Approx(value.norm() / std::sqrt(3.0)).epsilon(1e-5));
      matrix.block<3, 3>(static_cast<Eigen::Index>(3 * i), static_cast<Eigen::Index>(3 * j)) =
          rows[i].root() * value * columns[j].root();
    }
  }
  return matrix;
}

void check_scales(const std::vector<CoefficientScale>& scales, const Eigen::MatrixXd& exact, double tolerance) {
  REQUIRE(3 * scales.size() == static_cast<std::size_t>(exact.rows()));
  for (std::size_t i = 0; i < scales.size(); ++i) {
    const auto& scale = scales[i];
    const Eigen::Matrix3d diagonal = scale.root() * scale.diagonal() * scale.root();
    CHECK((diagonal - block(exact, i, i)).norm() < tolerance);
    CHECK((scale.root() * scale.inverse() - Eigen::Matrix3d::Identity()).norm() < 1e-9);
  }
}

// strict upper half of blocks
Eigen::MatrixXd before_diagonal(Eigen::MatrixXd matrix) {
  for (Eigen::Index j = 0; j < matrix.cols(); j += 3) matrix.block(j, j, matrix.rows() - j, 3).setZero();
  return matrix;
}

TEST_CASE("with nothing left out the pyramid is T U T^T on every level") {
  for (const bool lifted : {true, false}) {
    CAPTURE(lifted);
    const auto wavelet = wavelet_of(body(), lifted);
    const auto exact = test::dense_form(wavelet, body().compliance);
    const auto pyramid = pyramid_of(lifted, 0.0);
    const double tolerance = 2e-6 * body().compliance.cwiseAbs().maxCoeff();  // columns are held in single precision
    REQUIRE(pyramid.levels.size() == 4);
    REQUIRE(pyramid.coarse.size() == 3);
    for (std::size_t level = 0; level < 3; ++level) {
      CAPTURE(level);
      const auto& coarse = pyramid.coarse[level];
      REQUIRE(coarse.rows() == wavelet.row_end(level));
      double worst = 0;
      for (std::size_t j = 0; j < coarse.rows(); ++j) {
        for (std::size_t i = 0; i < coarse.rows(); ++i) {
          worst = std::max(worst, (coarse.block(i, j) - block(exact.averages[level], i, j)).cwiseAbs().maxCoeff());
          if (coarse.block(i, j) != coarse.block(j, i).transpose()) FAIL("not symmetric at ", i, ", ", j);
        }
      }
      CHECK(worst < tolerance);
    }
    for (std::size_t level = 0; level < 4; ++level) {
      CAPTURE(level);
      const auto& own = pyramid.levels[level];
      const auto& partner = own.partner;
      if (level == 0) {
        check_scales(own.averages, exact.averages[0], tolerance);
        CHECK(own.details.empty());
        const auto same = unscaled(partner[2], own.averages.data(), own.averages.data());
        CHECK((same - before_diagonal(exact.averages[0])).cwiseAbs().maxCoeff() < tolerance);
        continue;
      }
      if (level == 1) check_scales(own.averages, exact.averages[1], tolerance);
      if (level > 1) CHECK(own.averages.empty());
      check_scales(own.details, exact.details[level], tolerance);
      const auto same = unscaled(partner[2], own.details.data(), own.details.data());
      CHECK((same - before_diagonal(exact.details[level])).cwiseAbs().maxCoeff() < tolerance);
      const std::size_t below = level > 1 ? level - 2 : 0;
      const auto averages = unscaled(partner[0], pyramid.levels[below].averages.data(), own.details.data());
      const Eigen::MatrixXd crossed = exact.crossed[level].transpose();
      REQUIRE(partner[0].rows == wavelet.row_end(below));
      CHECK((averages - crossed.topRows(averages.rows())).cwiseAbs().maxCoeff() < tolerance);
      REQUIRE(averages.norm() > 0);
      if (level == 1) {
        CHECK(partner[1].row.empty());
        continue;
      }
      const auto parents = unscaled(partner[1], pyramid.levels[level - 1].details.data(), own.details.data());
      REQUIRE(averages.rows() + parents.rows() == crossed.rows());
      CHECK((parents - crossed.bottomRows(parents.rows())).cwiseAbs().maxCoeff() < tolerance);
    }
  }
}

TEST_CASE("averages are scaled by the root of their conditional compliance") {
  const auto wavelet = wavelet_of(body(), true);
  const auto exact = test::dense_form(wavelet, body().compliance);
  const auto pyramid = pyramid_of(true, 0.01);
  for (std::size_t level = 0; level < 2; ++level) {
    const Eigen::MatrixXd inverse = exact.averages[level].inverse();
    for (std::size_t i = 0; i < pyramid.levels[level].averages.size(); ++i) {
      const Eigen::Matrix3d conditional = block(inverse, i, i).inverse();
      const auto& root = pyramid.levels[level].averages[i].root();
      CHECK((root * root - conditional).norm() < 1e-4 * conditional.norm());
    }
  }
}

TEST_CASE("a floor leaves out couplings, and only small ones") {
  const auto all = pyramid_of(true, 0.0), some = pyramid_of(true, 0.02);
  for (std::size_t level = 1; level < 4; ++level) {
    for (int partner = 0; partner < 3; ++partner) {
      CAPTURE(level);
      CAPTURE(partner);
      const auto &a = all.levels[level].partner[partner], &s = some.levels[level].partner[partner];
      REQUIRE(a.begin.size() == s.begin.size());
      float largest_left_out = 0;
      for (std::size_t j = 0; j + 1 < a.begin.size(); ++j) {
        CHECK(std::is_sorted(s.row.begin() + static_cast<std::ptrdiff_t>(s.begin[j]),
                             s.row.begin() + static_cast<std::ptrdiff_t>(s.begin[j + 1])));
        std::size_t kept = s.begin[j];
        for (std::size_t b = a.begin[j]; b < a.begin[j + 1]; ++b) {
          if (kept < s.begin[j + 1] && s.row[kept] == a.row[b]) {
            ++kept;
          } else {
            largest_left_out = std::max(largest_left_out, a.norm[b]);
          }
        }
        CHECK(kept == s.begin[j + 1]);
      }
      if (partner != 1 || level > 1) CHECK(s.row.size() < a.row.size());
      CHECK(static_cast<double>(largest_left_out) < 0.3);
    }
  }
  CHECK(some.levels[0].partner[2].row.size() == all.levels[0].partner[2].row.size());
}

TEST_CASE("the exact columns are read once and in order") {
  const auto wavelet = wavelet_of(body(), true);
  std::size_t next = 0;
  const auto columns = test::columns_of(body().compliance);
  double last = 0;
  (void)build_pyramid(
      wavelet,
      [&](std::size_t first, std::size_t count) {
        CHECK(first == next);
        next += count;
        return columns(first, count);
      },
      0.1,
      [&](double fraction, std::string_view) {
        CHECK(fraction >= last);
        last = fraction;
      });
  CHECK(next == wavelet.rows());
  CHECK(last == 1.0);
}

TEST_CASE("a mesh of one level has averages only") {
  const auto b = test::make_body(0);
  const auto pyramid = build_pyramid(wavelet_of(b, true), test::columns_of(b.compliance), 0.0, {});
  REQUIRE(pyramid.levels.size() == 1);
  REQUIRE(pyramid.coarse.size() == 1);
  check_scales(pyramid.levels[0].averages, b.compliance, 1e-6 * b.compliance.cwiseAbs().maxCoeff());
}

TEST_CASE("columns that are not those of an elastic body are refused") {
  auto b = test::make_body(2);
  const auto build = [&](const ColumnSource& columns) { return build_pyramid(wavelet_of(b, true), columns, 0.01, {}); };
  SUBCASE("not a number") {
    b.compliance(5, 200) = std::numeric_limits<double>::quiet_NaN();
    CHECK_THROWS_WITH_AS((void)build(test::columns_of(b.compliance)), doctest::Contains("finite numbers"),
                         std::invalid_argument);
  }
  SUBCASE("of another size") {
    const Eigen::MatrixXd cut = b.compliance.topRows(b.compliance.rows() - 3);
    CHECK_THROWS_WITH_AS((void)build(test::columns_of(cut)), doctest::Contains("finite numbers"),
                         std::invalid_argument);
  }
  SUBCASE("a negative detail") {
    const Eigen::MatrixXd negative = -b.compliance;
    CHECK_THROWS_WITH_AS((void)build(test::columns_of(negative)), doctest::Contains("not positive definite"),
                         std::invalid_argument);
  }
  SUBCASE("indefinite on the coarsest level only") {
    const auto wavelet = wavelet_of(b, true);
    // as averages, a constant field along x far below zero
    Eigen::VectorXd constant = Eigen::VectorXd::Zero(3 * static_cast<Eigen::Index>(wavelet.row_end(0)));
    for (Eigen::Index i = 0; i < constant.size(); i += 3) constant(i) = 1;
    for (std::size_t level = 1; level <= wavelet.finest(); ++level) {
      Eigen::VectorXd finer = Eigen::VectorXd::Zero(3 * static_cast<Eigen::Index>(wavelet.row_end(level)));
      finer.head(constant.size()) = constant;
      constant = test::backward_step(wavelet, level) * finer;
    }
    b.compliance -= b.compliance.norm() / constant.squaredNorm() * constant * constant.transpose();
    CHECK_THROWS_WITH_AS((void)build(test::columns_of(b.compliance)),
                         doctest::Contains("averages of a coarse level is not positive"), std::invalid_argument);
  }
}

}  // namespace
}  // namespace greenloop::offline
