#include "offline/compress/encode/compressed_compliance.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>

#include "formats/stored_blocks.hpp"
#include "formats/verify.hpp"
#include "offline/compress/testing/dense_compliance.hpp"

namespace greenloop::offline {
namespace {

using test::Scalars;
using test::Vectors;

template <unsigned N>
const test::Body& body() {
  static const test::Body value = test::make_body<N>(3);
  return value;
}

// most layers carry something
template <unsigned N>
const test::File& file(layout::Wavelet kind) {
  constexpr Encoding encoding{.threshold = 0.004, .quantum = 0.002};
  static const test::File files[] = {
      test::File(test::model_of<N>(body<N>(), layout::wavelets[0], encoding)),
      test::File(test::model_of<N>(body<N>(), layout::wavelets[1], encoding)),
      test::File(test::model_of<N>(body<N>(), layout::wavelets[2], encoding)),
      test::File(test::model_of<N>(body<N>(), layout::wavelets[3], encoding)),
      test::File(test::model_of<N>(body<N>(), layout::wavelets[4], encoding)),
  };
  return files[static_cast<std::uint32_t>(kind) - 1];
}

template <unsigned N>
Eigen::MatrixXd all_columns(const CompressedCompliance<N>& compressed, std::size_t level) {
  const std::size_t rows = compressed.rows(level);
  Eigen::MatrixXd matrix(block_begin<N>(rows), block_begin<N>(rows));
  for (std::size_t j = 0; j < rows; ++j) {
    const auto column = compressed.column(level, j);
    REQUIRE(column.size() == block_numbers<N> * rows);
    for (std::size_t i = 0; i < rows; ++i) {
      matrix.block<N, N>(block_begin<N>(i), block_begin<N>(j)) =
          Eigen::Map<const SquareMatrix<N>>(column.data() + block_numbers<N> * i);
    }
  }
  return matrix;
}

std::vector<double> noise(std::size_t count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<double> x(count);
  for (auto& value : x) value = static_cast<double>(random() >> 11) * 0x1p-53 - 0.5;
  return x;
}

template <unsigned N>
std::vector<double> coefficients_of(const CompressedCompliance<N>& compressed, std::vector<double> x) {
  for (std::size_t l = compressed.finest(); l > 0; --l) compressed.wavelet().split(l, N, x.data());
  return x;
}

TEST_CASE_TEMPLATE("a field with fewer details has the same coefficients up to those, and none beyond", T, Scalars,
                   Vectors) {
  constexpr unsigned N = T::value;
  const CompressedCompliance<N> compressed(file<N>(layout::Wavelet::lifted_linear).view);
  const std::size_t finest = compressed.finest(), size = N * compressed.rows(finest);
  for (std::size_t level = 0; level <= finest; ++level) {
    const auto f = noise(N * compressed.rows(level), level);
    std::vector<double> x(size);
    compressed.displace(level, finest, 1, f.data(), x.data());
    const auto whole = coefficients_of(compressed, x);
    const double largest = *std::max_element(whole.begin(), whole.end());
    for (std::size_t details = 0; details <= finest; ++details) {
      CAPTURE(level);
      CAPTURE(details);
      compressed.displace(level, details, 1, f.data(), x.data());
      const auto cut = coefficients_of(compressed, x);
      const std::size_t end = N * compressed.rows(details);
      double difference = 0;
      for (std::size_t i = 0; i < size; ++i)
        difference = std::max(difference, std::abs(cut[i] - (i < end ? whole[i] : 0)));
      CHECK(difference < 1e-12 * largest);
    }
  }
}

TEST_CASE_TEMPLATE("between some nodes stands what their columns say", T, Scalars, Vectors) {
  constexpr unsigned N = T::value;
  for (const layout::Wavelet kind : layout::wavelets) {
    CAPTURE(kind);
    const CompressedCompliance<N> compressed(file<N>(kind).view);
    for (std::size_t level = 0; level < 4; ++level) {
      CAPTURE(level);
      const Eigen::MatrixXd all = all_columns(compressed, level);
      std::vector<std::size_t> nodes;
      for (std::size_t j = 1; j < compressed.rows(level); j += 3) nodes.push_back(j);
      double difference = 0;
      const Eigen::MatrixXd between = compressed.between(level, nodes);
      REQUIRE(between.rows() == block_begin<N>(nodes.size()));
      REQUIRE(between.cols() == block_begin<N>(nodes.size()));
      for (std::size_t a = 0; a < nodes.size(); ++a) {
        for (std::size_t b = 0; b < nodes.size(); ++b) {
          const SquareMatrix<N> expected = all.block<N, N>(block_begin<N>(nodes[a]), block_begin<N>(nodes[b])),
                                found = between.block<N, N>(block_begin<N>(a), block_begin<N>(b));
          difference = std::max(difference, (found - expected).norm());
        }
      }
      CHECK(difference < 1e-13 * all.norm());
    }
  }
}

TEST_CASE_TEMPLATE("every level is the wavelet form evaluated densely", T, Scalars, Vectors) {
  constexpr unsigned N = T::value;
  for (const layout::Wavelet kind : layout::wavelets) {
    CAPTURE(kind);
    const auto expected = test::dense_compliances(file<N>(kind).view);
    const CompressedCompliance<N> compressed(file<N>(kind).view);
    REQUIRE(compressed.finest() == 3);
    for (std::size_t level = 0; level < 4; ++level) {
      CAPTURE(level);
      const Eigen::MatrixXd found = all_columns(compressed, level);
      const double largest = expected[level].cwiseAbs().maxCoeff();
      CHECK((found - expected[level]).cwiseAbs().maxCoeff() < 1e-6 * largest);
      CHECK((found - found.transpose()).cwiseAbs().maxCoeff() < 1e-12 * largest);
    }
    for (std::uint32_t layer = 1; layer < layout::layers; ++layer) {
      CHECK(block_count(file<N>(kind).view, layer, layer + 1) > 10);
    }
  }
}

TEST_CASE_TEMPLATE("all layers come near the exact compliance, on every level", T, Scalars, Vectors) {
  constexpr unsigned N = T::value;
  const SurfaceWavelet wavelet(body<N>().mesh, body<N>().flags, body<N>().area, layout::Wavelet::lifted_linear);
  const auto exact = test::level_compliances<N>(wavelet, body<N>().compliance);
  const CompressedCompliance<N> compressed(file<N>(layout::Wavelet::lifted_linear).view);
  for (std::size_t level = 0; level < 4; ++level) {
    CAPTURE(level);
    CHECK((all_columns(compressed, level) - exact[level]).norm() < 0.02 * exact[level].norm());
  }
}

TEST_CASE_TEMPLATE("several force patterns at once are the same as one after the other", T, Scalars, Vectors) {
  constexpr unsigned N = T::value;
  const CompressedCompliance<N> compressed(file<N>(layout::Wavelet::lifted_linear).view);
  for (std::size_t level = 0; level < 4; ++level) {
    const std::size_t rows = compressed.rows(level);
    const auto f = noise(3 * N * rows, 5);
    std::vector<double> together(3 * N * rows);
    compressed.apply(level, 3, f.data(), together.data());
    for (std::size_t pattern = 0; pattern < 3; ++pattern) {
      std::vector<double> one(N * rows), x(N * rows);
      for (std::size_t i = 0; i < rows; ++i) {
        for (std::size_t k = 0; k < N; ++k) one[N * i + k] = f[N * (3 * i + pattern) + k];
      }
      compressed.apply(level, 1, one.data(), x.data());
      double worst = 0, largest = 0;
      for (std::size_t i = 0; i < rows; ++i) {
        for (std::size_t k = 0; k < N; ++k) {
          worst = std::max(worst, std::abs(x[N * i + k] - together[N * (3 * i + pattern) + k]));
          largest = std::max(largest, std::abs(x[N * i + k]));
        }
      }
      CHECK(worst <= 1e-14 * largest);
      CHECK(largest > 0);
    }
  }
}

TEST_CASE_TEMPLATE("a file cut off after a level stands for the same compliance there", T, Scalars, Vectors) {
  constexpr unsigned N = T::value;
  const auto& whole = file<N>(layout::Wavelet::lifted_linear);
  const CompressedCompliance<N> compressed(whole.view);
  for (std::uint32_t q = 0; q < 3; ++q) {
    CAPTURE(q);
    const AlignedBytes bytes(truncate_to_level({whole.bytes.data(), whole.bytes.data() + whole.bytes.size()}, q));
    ModelView view;
    REQUIRE(verify(bytes.span(), view).ok());
    const CompressedCompliance<N> cut(view);
    REQUIRE(cut.finest() == q);
    const Eigen::MatrixXd expected = all_columns(compressed, q);
    CHECK((all_columns(cut, q) - expected).norm() < 1e-14 * expected.norm());
  }
}

TEST_CASE_TEMPLATE("a body of one level", T, Scalars, Vectors) {
  constexpr unsigned N = T::value;
  const auto small = test::make_body<N>(0);
  const test::File model(
      test::model_of<N>(small, layout::Wavelet::lifted_linear, {.threshold = 1e-5, .quantum = 1e-5}));
  const Eigen::MatrixXd found = all_columns(CompressedCompliance<N>(model.view), 0);
  CHECK((found - small.compliance).norm() < 1e-4 * small.compliance.norm());
}

TEST_CASE("a model of other components is refused") {
  const layout::Wavelet kind = layout::Wavelet::lifted_linear;
  CHECK_THROWS_AS(CompressedCompliance<3>(file<1>(kind).view), std::invalid_argument);
  CHECK_THROWS_AS(CompressedCompliance<1>(file<3>(kind).view), std::invalid_argument);
}

}  // namespace
}  // namespace greenloop::offline
