#include "offline/figures/comparison.hpp"

#include <doctest/doctest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "offline/compress/testing/dense_compliance.hpp"
#include "offline/figures/comparison_figures.hpp"
#include "runtime/prices.hpp"

namespace greenloop::offline {
namespace {

ExactBody exact_body(const test::Body& body, const char* name) {
  return {.name = name,
          .mesh = body.mesh,
          .flags = body.flags,
          .area = body.area,
          .columns = test::columns_of(body.compliance)};
}

const test::Body& body() {
  static const test::Body value = test::make_body(2);
  return value;
}

const ComparisonPlan& plan() {
  static const ComparisonPlan value{.column_thresholds = {0.005, 0.02, 0.1, 0.3},
                                    .two_sided_thresholds = {0.0025, 0.01, 0.04, 0.16},
                                    .quanta = {0.5},
                                    .summation_thresholds = {0.002, 0.004, 0.006, 0.01},
                                    .contacts = 12,
                                    .rounds = 3};
  return value;
}

const BodyComparison& compared() {
  static const BodyComparison value = compare_forms(exact_body(body(), "blob"), plan(), {});
  return value;
}

// errors grow and blocks become fewer with the threshold
void check_monotone(const std::vector<LevelRates>& levels) {
  for (const LevelRates& level : levels) {
    CAPTURE(level.level);
    for (std::size_t t = 1; t < level.points.size(); ++t) {
      CHECK(level.points[t].rms > level.points[t - 1].rms);
      CHECK(level.points[t].worst_column > 0.99 * level.points[t - 1].worst_column);
      CHECK(level.points[t].ratio >= level.points[t - 1].ratio);
    }
  }
}

TEST_CASE("errors and compression grow with the threshold, on every level, in both forms") {
  REQUIRE(compared().forms.size() == std::size(wavelet_kinds));
  for (const FormRates& form : compared().forms) {
    CAPTURE(form.wavelet);
    REQUIRE(form.column.size() == 3);
    REQUIRE(form.two_sided.size() == 3);
    check_monotone(form.column);
    check_monotone({form.two_sided.back()});
    CHECK(form.column.back().columns == compared().rows);
  }
}

TEST_CASE("one-sided columns are the paper's, by dense products") {
  const SurfaceWavelet wavelet(body().mesh, body().flags, body().area, layout::Wavelet::lifted_linear);
  const std::size_t finest = wavelet.finest(), rows = wavelet.rows();
  Eigen::VectorXd area(3 * rows);
  for (std::size_t i = 0; i < rows; ++i) {
    area.segment<3>(static_cast<Eigen::Index>(3 * i)).setConstant(body().area[wavelet.nodes()[i]]);
  }
  const Eigen::MatrixXd traction = body().compliance * area.asDiagonal();
  const Eigen::MatrixXd forward = test::forward_transform(wavelet, finest);
  const std::size_t level = 1, columns = wavelet.row_end(level);
  REQUIRE(finest == level + 1);
  const Eigen::MatrixXd scaling =
      Eigen::MatrixXd(test::backward_step(wavelet, finest)).leftCols(static_cast<Eigen::Index>(3 * columns));
  const Eigen::MatrixXd exact = traction * scaling;
  const double epsilon = 0.1;
  Eigen::MatrixXd kept = forward * exact;
  std::size_t count = 0;
  for (std::size_t j = 0; j < columns; ++j) {
    double peak = 0;
    const auto block = [&](const Eigen::MatrixXd& of, std::size_t i) {
      return of.block<3, 3>(static_cast<Eigen::Index>(3 * i), static_cast<Eigen::Index>(3 * j));
    };
    for (std::size_t i = 0; i < rows; ++i) peak = std::max(peak, block(exact, i).norm());
    for (std::size_t i = 0; i < rows; ++i) {
      std::size_t own = 0;
      while (i >= wavelet.row_end(own)) ++own;
      const double share = std::ldexp(epsilon, static_cast<int>(own) - static_cast<int>(finest));
      if (own == 0 || block(kept, i).norm() >= share * peak) {
        ++count;
      } else {
        kept.block<3, 3>(static_cast<Eigen::Index>(3 * i), static_cast<Eigen::Index>(3 * j)).setZero();
      }
    }
  }
  const double error = (forward.inverse() * kept - exact).norm() / exact.norm();
  const RatePoint& point = compared().forms.back().column[level].points[2];
  CHECK(point.threshold == epsilon);
  CHECK(point.rms == doctest::Approx(error).epsilon(1e-3));
  CHECK(point.ratio == doctest::Approx(static_cast<double>(rows * columns) / static_cast<double>(count)).epsilon(0.01));
}

TEST_CASE("at equal compression two-sided forces are closer than one-sided ones") {
  const FormRates& form = compared().forms.back();
  const RatePoint& ours = form.two_sided.back().points[1];
  const auto theirs = interpolate(form.column.back().points, &RatePoint::ratio, ours.ratio, &RatePoint::patch_force);
  MESSAGE("times fewer blocks ", ours.ratio, ": patch force error ", ours.patch_force, ", one-sided ",
          theirs.value_or(std::numeric_limits<double>::infinity()));
  CHECK(ours.patch_force < 0.2);
  CHECK(ours.patch_force < theirs.value_or(std::numeric_limits<double>::infinity()));
  CHECK(ours.rms < ours.patch_force);
}

TEST_CASE("a step's work is linear in the blocks summed") {
  REQUIRE(compared().summation.size() == plan().summation_thresholds.size());
  const SummationFit fit = fit_summation(compared().summation);
  CHECK(fit.work.r_squared > 0.999);
  CHECK(fit.work.slope == doctest::Approx(Prices{}.summed_block / 256.0).epsilon(0.05));
  CHECK(fit.work.intercept > 0);
  for (const SummationPoint& point : compared().summation) CHECK(point.seconds > 0);
}

TEST_CASE("growth is the ratio of compressions at one error") {
  auto small = compared(), large = compared();
  small.rows = 1;
  small.name = "small";
  for (RatePoint& point : large.forms.back().column.back().points) point.ratio *= 3;
  const auto steps = growth({large, small});
  REQUIRE(steps.size() == 5);
  bool any = false;
  for (const Growth& step : steps) {
    CHECK(step.from == "small");
    CHECK(step.to == "blob");
    if (!step.column) continue;
    CHECK(*step.column == doctest::Approx(3));
    any = true;
  }
  CHECK(any);
}

TEST_CASE("interpolation and line fit") {
  std::vector<RatePoint> points(3);
  for (std::size_t i = 0; i < 3; ++i) {
    points[i].rms = std::pow(10.0, i);
    points[i].ratio = std::pow(100.0, i);
  }
  CHECK(*interpolate(points, &RatePoint::rms, std::sqrt(10.0), &RatePoint::ratio) == doctest::Approx(10));
  CHECK_FALSE(interpolate(points, &RatePoint::rms, 0.5, &RatePoint::ratio));
  points[1].ratio = std::numeric_limits<double>::infinity();
  CHECK(*interpolate(points, &RatePoint::rms, 10, &RatePoint::ratio) == doctest::Approx(100));
  const LineFit line = fit_line({1, 2, 4}, {5, 7, 11});
  CHECK(line.slope == doctest::Approx(2));
  CHECK(line.intercept == doctest::Approx(3));
  CHECK(line.r_squared == doctest::Approx(1));
  CHECK(fit_line({1, 2, 3}, {0, 1, 0}).r_squared == doctest::Approx(0));
  CHECK_THROWS_AS((void)fit_line({1, 1}, {0, 1}), std::invalid_argument);
}

TEST_CASE("every figure has its curves and no number that is none") {
  const auto larger = [] {
    auto other = compared();
    other.name = "larger";
    other.rows *= 4;
    return other;
  }();
  for (const Figure& figure :
       {error_over_ratio(compared()), error_over_threshold(compared()), level_errors_over_ratio(compared()),
        summation_cost(compared()), growth_figure({compared(), larger})}) {
    CAPTURE(figure.name);
    CHECK(figure.svg().find("<circle") != std::string::npos);
    CHECK(figure.svg().find("nan") == std::string::npos);
    CHECK(figure.svg().find("inf") == std::string::npos);
  }
  CHECK(error_over_ratio(compared()).svg().find("lifted linear, one-sided") != std::string::npos);
}

}  // namespace
}  // namespace greenloop::offline
