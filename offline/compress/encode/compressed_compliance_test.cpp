#include "offline/compress/encode/compressed_compliance.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <random>

#include "formats/stored_blocks.hpp"
#include "formats/verify.hpp"
#include "offline/compress/testing/dense_compliance.hpp"

namespace greenloop::offline {
namespace {

const test::Body& body() {
  static const test::Body value = test::make_body(3);
  return value;
}

// most layers carry something
const test::File& file(layout::Wavelet kind) {
  constexpr Encoding encoding{.threshold = 0.004, .quantum = 0.002};
  static const test::File files[] = {
      test::File(test::model_of(body(), layout::wavelets[0], encoding)),
      test::File(test::model_of(body(), layout::wavelets[1], encoding)),
      test::File(test::model_of(body(), layout::wavelets[2], encoding)),
      test::File(test::model_of(body(), layout::wavelets[3], encoding)),
      test::File(test::model_of(body(), layout::wavelets[4], encoding)),
  };
  return files[static_cast<std::uint32_t>(kind) - 1];
}

Eigen::MatrixXd all_columns(const CompressedCompliance& compressed, std::size_t level) {
  const std::size_t rows = compressed.rows(level);
  Eigen::MatrixXd matrix(static_cast<Eigen::Index>(3 * rows), static_cast<Eigen::Index>(3 * rows));
  for (std::size_t j = 0; j < rows; ++j) {
    const auto column = compressed.column(level, j);
    REQUIRE(column.size() == 9 * rows);
    for (std::size_t i = 0; i < rows; ++i) {
      matrix.block<3, 3>(static_cast<Eigen::Index>(3 * i), static_cast<Eigen::Index>(3 * j)) =
          Eigen::Map<const Eigen::Matrix3d>(column.data() + 9 * i);
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

std::vector<double> coefficients_of(const CompressedCompliance& compressed, std::vector<double> x) {
  for (std::size_t l = compressed.finest(); l > 0; --l) compressed.wavelet().split(l, 3, x.data());
  return x;
}

TEST_CASE("a field with fewer details has the same coefficients up to those, and none beyond") {
  const CompressedCompliance compressed(file(layout::Wavelet::lifted_linear).view);
  const std::size_t finest = compressed.finest(), size = 3 * compressed.rows(finest);
  for (std::size_t level = 0; level <= finest; ++level) {
    const auto f = noise(3 * compressed.rows(level), level);
    std::vector<double> x(size);
    compressed.displace(level, finest, 1, f.data(), x.data());
    const auto whole = coefficients_of(compressed, x);
    const double largest = *std::max_element(whole.begin(), whole.end());
    for (std::size_t details = 0; details <= finest; ++details) {
      CAPTURE(level);
      CAPTURE(details);
      compressed.displace(level, details, 1, f.data(), x.data());
      const auto cut = coefficients_of(compressed, x);
      const std::size_t end = 3 * compressed.rows(details);
      double difference = 0;
      for (std::size_t i = 0; i < size; ++i)
        difference = std::max(difference, std::abs(cut[i] - (i < end ? whole[i] : 0)));
      CHECK(difference < 1e-12 * largest);
    }
  }
}

TEST_CASE("between some nodes stands what their columns say") {
  for (const layout::Wavelet kind : layout::wavelets) {
    CAPTURE(kind);
    const CompressedCompliance compressed(file(kind).view);
    for (std::size_t level = 0; level < 4; ++level) {
      CAPTURE(level);
      const Eigen::MatrixXd all = all_columns(compressed, level);
      std::vector<std::size_t> nodes;
      for (std::size_t j = 1; j < compressed.rows(level); j += 3) nodes.push_back(j);
      double difference = 0;
      const Eigen::MatrixXd between = compressed.between(level, nodes);
      const auto size = static_cast<Eigen::Index>(nodes.size());
      REQUIRE(between.rows() == 3 * size);
      REQUIRE(between.cols() == 3 * size);
      for (Eigen::Index a = 0; a < size; ++a) {
        for (Eigen::Index b = 0; b < size; ++b) {
          const Eigen::Matrix3d expected =
              all.block<3, 3>(3 * static_cast<Eigen::Index>(nodes[a]), 3 * static_cast<Eigen::Index>(nodes[b]));
          difference = std::max(difference, (between.block<3, 3>(3 * a, 3 * b) - expected).norm());
        }
      }
      CHECK(difference < 1e-13 * all.norm());
    }
  }
}

TEST_CASE("every level is the wavelet form evaluated densely") {
  for (const layout::Wavelet kind : layout::wavelets) {
    CAPTURE(kind);
    const auto expected = test::dense_compliances(file(kind).view);
    const CompressedCompliance compressed(file(kind).view);
    REQUIRE(compressed.finest() == 3);
    for (std::size_t level = 0; level < 4; ++level) {
      CAPTURE(level);
      const Eigen::MatrixXd found = all_columns(compressed, level);
      const double largest = expected[level].cwiseAbs().maxCoeff();
      CHECK((found - expected[level]).cwiseAbs().maxCoeff() < 1e-6 * largest);
      CHECK((found - found.transpose()).cwiseAbs().maxCoeff() < 1e-12 * largest);
    }
    for (std::uint32_t layer = 1; layer < layout::layers; ++layer) {
      CHECK(block_count(file(kind).view, layer, layer + 1) > 10);
    }
  }
}

TEST_CASE("all layers come near the exact compliance, on every level") {
  const SurfaceWavelet wavelet(body().mesh, body().flags, body().area, layout::Wavelet::lifted_linear);
  const auto exact = test::level_compliances(wavelet, body().compliance);
  const CompressedCompliance compressed(file(layout::Wavelet::lifted_linear).view);
  for (std::size_t level = 0; level < 4; ++level) {
    CAPTURE(level);
    CHECK((all_columns(compressed, level) - exact[level]).norm() < 0.02 * exact[level].norm());
  }
}

TEST_CASE("several force patterns at once are the same as one after the other") {
  const CompressedCompliance compressed(file(layout::Wavelet::lifted_linear).view);
  for (std::size_t level = 0; level < 4; ++level) {
    const std::size_t rows = compressed.rows(level);
    const auto f = noise(9 * rows, 5);
    std::vector<double> together(9 * rows);
    compressed.apply(level, 3, f.data(), together.data());
    for (std::size_t pattern = 0; pattern < 3; ++pattern) {
      std::vector<double> one(3 * rows), x(3 * rows);
      for (std::size_t i = 0; i < rows; ++i) {
        for (std::size_t k = 0; k < 3; ++k) one[3 * i + k] = f[9 * i + 3 * pattern + k];
      }
      compressed.apply(level, 1, one.data(), x.data());
      double worst = 0, largest = 0;
      for (std::size_t i = 0; i < rows; ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
          worst = std::max(worst, std::abs(x[3 * i + k] - together[9 * i + 3 * pattern + k]));
          largest = std::max(largest, std::abs(x[3 * i + k]));
        }
      }
      CHECK(worst <= 1e-14 * largest);
      CHECK(largest > 0);
    }
  }
}

TEST_CASE("a file cut off after a level stands for the same compliance there") {
  const auto& whole = file(layout::Wavelet::lifted_linear);
  const CompressedCompliance compressed(whole.view);
  for (std::uint32_t q = 0; q < 3; ++q) {
    CAPTURE(q);
    const AlignedBytes bytes(truncate_to_level({whole.bytes.data(), whole.bytes.data() + whole.bytes.size()}, q));
    ModelView view;
    REQUIRE(verify(bytes.span(), view).ok());
    const CompressedCompliance cut(view);
    REQUIRE(cut.finest() == q);
    const Eigen::MatrixXd expected = all_columns(compressed, q);
    CHECK((all_columns(cut, q) - expected).norm() < 1e-14 * expected.norm());
  }
}

TEST_CASE("a body of one level") {
  const auto small = test::make_body(0);
  const test::File model(test::model_of(small, layout::Wavelet::lifted_linear, {.threshold = 1e-5, .quantum = 1e-5}));
  const Eigen::MatrixXd found = all_columns(CompressedCompliance(model.view), 0);
  CHECK((found - small.compliance).norm() < 1e-4 * small.compliance.norm());
}

}  // namespace
}  // namespace greenloop::offline
