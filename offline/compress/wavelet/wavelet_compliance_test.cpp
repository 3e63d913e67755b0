#include "offline/compress/wavelet/wavelet_compliance.hpp"

#include <doctest/doctest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "offline/compress/testing/dense_compliance.hpp"
#include "offline/compress/wavelet/equilibrated_prediction.hpp"

namespace greenloop::offline {
namespace {

using test::Scalars;
using test::Vectors;

template <unsigned N>
const test::Body& body() {
  static const test::Body value = test::make_body<N>(3);
  return value;
}

template <unsigned N>
SurfaceWavelet wavelet_of(const test::Body& b, layout::Wavelet kind) {
  return make_wavelet<N>(b.mesh, b.flags, b.area, kind, test::columns_of<N>(b.compliance));
}

template <unsigned N>
WaveletCompliance<N> transformed(layout::Wavelet kind, double floor) {
  const test::Body& own = body<N>();
  return transform_compliance<N>(wavelet_of<N>(own, kind), test::columns_of<N>(own.compliance), floor, {});
}

template <unsigned N>
SquareMatrix<N> block(const Eigen::MatrixXd& matrix, std::size_t i, std::size_t j) {
  return matrix.block<N, N>(block_begin<N>(i), block_begin<N>(j));
}

// calls visit(row, column, place among the level's candidates, the level's candidates)
template <unsigned N, class Visit>
void visit_candidates(const WaveletCompliance<N>& compliance, Visit visit) {
  std::size_t column = 0;
  for (const auto& level : compliance.couplings) {
    for (std::size_t j = 0; j + 1 < level.begin.size(); ++j, ++column) {
      for (std::size_t b = level.begin[j]; b < level.begin[j + 1]; ++b) visit(level.row[b], column, b, level);
    }
  }
}

// with the scales taken out again, m/N
template <unsigned N>
Eigen::MatrixXd unscaled(const WaveletCompliance<N>& compliance) {
  const Eigen::Index size = block_begin<N>(compliance.scales.size());
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(size, size);
  for (std::size_t i = 0; i < compliance.scales.size(); ++i) {
    const auto& scale = compliance.scales[i];
    matrix.block<N, N>(block_begin<N>(i), block_begin<N>(i)) = scale.root() * scale.diagonal() * scale.root();
  }
  visit_candidates(compliance, [&](std::size_t i, std::size_t j, std::size_t b, const CouplingCandidates<N>& level) {
    const SquareMatrix<N> value =
        Eigen::Map<const SquareMatrixF<N>>(level.value.data() + block_numbers<N> * b).template cast<double>();
    CHECK(static_cast<double>(level.norm[b]) == doctest::Approx(value.norm() / std::sqrt(double{N})).epsilon(1e-5));
    const SquareMatrix<N> coupling = compliance.scales[i].root() * value * compliance.scales[j].root();
    matrix.block<N, N>(block_begin<N>(i), block_begin<N>(j)) = coupling;
    matrix.block<N, N>(block_begin<N>(j), block_begin<N>(i)) = coupling.transpose();
  });
  return matrix;
}

TEST_CASE_TEMPLATE("with nothing left out it is W U W^T", T, Scalars, Vectors) {
  constexpr unsigned N = T::value;
  for (const layout::Wavelet kind : layout::wavelets) {
    CAPTURE(kind);
    const auto wavelet = wavelet_of<N>(body<N>(), kind);
    const auto step = test::forward_transform<N>(wavelet, 3);
    const Eigen::MatrixXd exact = step * body<N>().compliance * step.transpose();
    const auto found = transformed<N>(kind, 0.0);
    REQUIRE(found.couplings.size() == 4);
    REQUIRE(found.scales.size() == wavelet.rows());
    const double tolerance = 2e-6 * body<N>().compliance.cwiseAbs().maxCoeff();  // columns are held in single precision
    CHECK((unscaled(found) - exact).cwiseAbs().maxCoeff() < tolerance);
    REQUIRE(found.coarse.rows() == wavelet.row_end(2));
    double worst = 0;
    for (std::size_t j = 0; j < found.coarse.rows(); ++j) {
      for (std::size_t i = 0; i < found.coarse.rows(); ++i) {
        worst = std::max(worst, (found.coarse.block(i, j) - block<N>(exact, i, j)).cwiseAbs().maxCoeff());
      }
    }
    CHECK(worst < tolerance);
  }
}

TEST_CASE_TEMPLATE("exact columns of coarse levels", T, Scalars, Vectors) {
  constexpr unsigned N = T::value;
  for (const layout::Wavelet kind : layout::wavelets) {
    const auto wavelet = wavelet_of<N>(body<N>(), kind);
    const auto exact = test::level_compliances<N>(wavelet, body<N>().compliance);
    const auto found = transformed<N>(kind, 0.1);
    for (std::size_t level = 0; level < 3; ++level) {
      CAPTURE(level);
      double worst = 0;
      for (std::size_t j = 0; j < wavelet.row_end(level); j += 7) {
        const auto column = exact_column(wavelet, found, level, j);
        REQUIRE(column.size() == block_numbers<N> * wavelet.row_end(level));
        for (std::size_t i = 0; i < wavelet.row_end(level); ++i) {
          const Eigen::Map<const SquareMatrix<N>> value(column.data() + block_numbers<N> * i);
          worst = std::max(worst, (value - block<N>(exact[level], i, j)).cwiseAbs().maxCoeff());
        }
      }
      CHECK(worst < 2e-6 * exact[level].cwiseAbs().maxCoeff());
    }
  }
}

TEST_CASE_TEMPLATE("scales lie between the diagonal block and what is left when all others are held", T, Scalars,
                   Vectors) {
  constexpr unsigned N = T::value;
  const auto step = test::forward_transform<N>(wavelet_of<N>(body<N>(), layout::Wavelet::lifted_linear), 3);
  const Eigen::MatrixXd exact = step * body<N>().compliance * step.transpose(), inverse = exact.inverse();
  const auto found = transformed<N>(layout::Wavelet::lifted_linear, 1e-4);
  double closest = 1;
  for (std::size_t i = 0; i < found.scales.size(); ++i) {
    const double conditional = (found.scales[i].root() * found.scales[i].root()).trace();
    const double least = block<N>(inverse, i, i).inverse().trace(), most = block<N>(exact, i, i).trace();
    CHECK(conditional > 0.99 * least);
    CHECK(conditional < 1.0001 * most);
    closest = std::min(closest, least / conditional);
  }
  CHECK(closest > 0.7);
}

TEST_CASE_TEMPLATE("a floor leaves out couplings, and only small ones", T, Scalars, Vectors) {
  constexpr unsigned N = T::value;
  const auto all = transformed<N>(layout::Wavelet::lifted_linear, 0.0),
             some = transformed<N>(layout::Wavelet::lifted_linear, 0.02);
  for (std::size_t level = 0; level < 4; ++level) {
    CAPTURE(level);
    const auto &a = all.couplings[level], &s = some.couplings[level];
    REQUIRE(a.begin.size() == s.begin.size());
    float largest_left_out = 0;
    for (std::size_t j = 0; j + 1 < a.begin.size(); ++j) {
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
    CHECK(s.row.size() < a.row.size());
    CHECK(static_cast<double>(largest_left_out) < 0.3);
  }
}

TEST_CASE_TEMPLATE("the exact columns are read once and in order", T, Scalars, Vectors) {
  constexpr unsigned N = T::value;
  const auto wavelet = wavelet_of<N>(body<N>(), layout::Wavelet::lifted_linear);
  std::size_t next = 0;
  const auto columns = test::columns_of<N>(body<N>().compliance);
  double last = 0;
  (void)transform_compliance<N>(
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

TEST_CASE_TEMPLATE("a mesh of one level has averages only", T, Scalars, Vectors) {
  constexpr unsigned N = T::value;
  const auto b = test::make_body<N>(0);
  const auto wavelet = wavelet_of<N>(b, layout::Wavelet::lifted_linear);
  const auto found = transform_compliance<N>(wavelet, test::columns_of<N>(b.compliance), 0.0, {});
  REQUIRE(found.couplings.size() == 1);
  CHECK((unscaled(found) - b.compliance).cwiseAbs().maxCoeff() < 1e-6 * b.compliance.cwiseAbs().maxCoeff());
  const auto column = exact_column(wavelet, found, 0, 1);
  CHECK((Eigen::Map<const SquareMatrix<N>>(column.data()) - block<N>(b.compliance, 0, 1)).norm() <
        1e-6 * b.compliance.norm());
}

TEST_CASE_TEMPLATE("columns that are not those of an elastic body are refused", T, Scalars, Vectors) {
  constexpr unsigned N = T::value;
  auto b = test::make_body<N>(2);
  const auto build = [&](const ExactColumns& columns) {
    return transform_compliance<N>(wavelet_of<N>(b, layout::Wavelet::lifted_linear), columns, 0.01, {});
  };
  SUBCASE("not a number") {
    b.compliance(5, 70) = std::numeric_limits<double>::quiet_NaN();
    CHECK_THROWS_WITH_AS((void)build(test::columns_of<N>(b.compliance)), doctest::Contains("finite numbers"),
                         std::invalid_argument);
  }
  SUBCASE("of another size") {
    const Eigen::MatrixXd cut = b.compliance.topRows(b.compliance.rows() - N);
    CHECK_THROWS_WITH_AS((void)build(test::columns_of<N>(cut)), doctest::Contains("finite numbers"),
                         std::invalid_argument);
  }
  SUBCASE("a negative detail") {
    const Eigen::MatrixXd negative = -b.compliance;
    CHECK_THROWS_WITH_AS((void)build(test::columns_of<N>(negative)), doctest::Contains("not positive definite"),
                         std::invalid_argument);
  }
}

TEST_CASE("weights of vectors do not predict scalars") {
  const auto wavelet = wavelet_of<3>(body<3>(), layout::Wavelet::equilibrated);
  CHECK_THROWS_AS((void)transform_compliance<1>(wavelet, test::columns_of<1>(body<1>().compliance), 0.1, {}),
                  std::invalid_argument);
}

}  // namespace
}  // namespace greenloop::offline
