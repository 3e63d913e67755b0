#include "offline/compress/column_codec.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "offline/compress/test_body.hpp"

namespace greenloop::offline {
namespace {

constexpr std::size_t width = LiftedLinear::components;

struct Fixture {
  test::Body body = test::make_body(3);
  LiftedLinear wavelet{body.mesh, body.flags, body.area};

  [[nodiscard]] TransformedColumn column(std::size_t j) const {
    return transform_column(wavelet, body.compliance, j, body.area[body.column_nodes[j]]);
  }
};

const Fixture& fixture() {
  static const Fixture value;
  return value;
}

TEST_CASE("a transformed column knows its values, norms and largest block") {
  const auto& f = fixture();
  const auto column = f.column(17);
  const Eigen::MatrixXd exact = f.body.compliance.middleCols<3>(Eigen::Index{3} * 17);
  double largest = 0;
  for (std::size_t i = 0; i < f.wavelet.rows(); ++i) {
    const Eigen::Matrix3d block = exact.middleRows<3>(static_cast<Eigen::Index>(3 * i));
    largest = std::max(largest, block.norm());
    for (Eigen::Index c = 0; c < 3; ++c) {
      for (Eigen::Index r = 0; r < 3; ++r) {
        CHECK(column.values[width * i + static_cast<std::size_t>(3 * c + r)] == static_cast<float>(block(r, c)));
      }
    }
  }
  CHECK(column.largest == doctest::Approx(largest).epsilon(1e-6));
  CHECK(column.energy == doctest::Approx(exact.squaredNorm()).epsilon(1e-6));
}

TEST_CASE("without a threshold 16 bits keep a column to 1e-3, and 8 bits are coarser but not bad") {
  const auto& f = fixture();
  const auto column = f.column(100);
  EncodedColumn encoded;
  std::vector<float> values;
  double error[2];
  for (std::uint32_t bytes = 1; bytes <= 2; ++bytes) {
    encode_column(f.wavelet, column, 0.0, std::vector<std::uint32_t>(4, bytes), encoded);
    CHECK(encoded.blocks() == f.wavelet.rows());
    decode_column(f.wavelet, encoded, values);
    error[bytes - 1] = column_error(column, values).largest;
  }
  CHECK(error[1] < 1e-4);
  CHECK(error[0] < 0.05);
  CHECK(error[0] > 30 * error[1]);
}

TEST_CASE("an endless threshold keeps just the base level") {
  const auto& f = fixture();
  EncodedColumn encoded;
  encode_column(f.wavelet, f.column(3), 1e30, {1, 1, 1, 1}, encoded);
  CHECK(encoded.blocks() == f.wavelet.row_begin(1));
  CHECK(encoded.levels[0].rows.size() == f.wavelet.row_begin(1));
}

TEST_CASE("exactly the blocks at or above the level's threshold are kept, in order and within the quanta") {
  const auto& f = fixture();
  const auto column = f.column(250);
  const double threshold = 0.05 * column.largest;
  EncodedColumn encoded;
  encode_column(f.wavelet, column, threshold, {1, 2, 1, 1}, encoded);
  for (std::size_t l = 0; l < 4; ++l) {
    const auto& level = encoded.levels[l];
    std::size_t expected = 0;
    for (std::size_t i = f.wavelet.row_begin(l); i < f.wavelet.row_begin(l + 1); ++i) {
      const bool kept =
          l == 0 || static_cast<double>(column.norms[i]) >= threshold * std::pow(2.0, static_cast<double>(l) - 3.0);
      expected += kept ? 1 : 0;
    }
    CHECK(level.rows.size() == expected);
    CHECK(std::is_sorted(level.rows.begin(), level.rows.end()));
    int largest = 0;
    for (const auto value : level.values) largest = std::max(largest, std::abs(int{value}));
    CHECK(largest == (l == 1 ? 32767 : 127));
    for (std::size_t b = 0; b < level.rows.size(); ++b) {
      for (std::size_t k = 0; k < width; ++k) {
        const float exact = column.coefficients[width * (f.wavelet.row_begin(l) + level.rows[b]) + k];
        const float stored = level.scale * static_cast<float>(level.values[width * b + k]);
        CHECK(std::abs(stored - exact) <= 0.5001F * level.scale);
      }
    }
  }
}

TEST_CASE("a column of zeros is stored as zeros") {
  const auto& f = fixture();
  const auto rows = static_cast<Eigen::Index>(3 * f.wavelet.rows());
  const auto column = transform_column(f.wavelet, Eigen::MatrixXd::Zero(rows, 3), 0, 1.0);
  EncodedColumn encoded;
  std::vector<float> values;
  encode_column(f.wavelet, column, 1e-9, {1, 1, 1, 1}, encoded);
  decode_column(f.wavelet, encoded, values);
  CHECK(encoded.levels[0].scale == 0.0F);
  CHECK(std::all_of(values.begin(), values.end(), [](float v) { return v == 0.0F; }));
  CHECK(column_error(column, values).largest == 0.0);
}

}  // namespace
}  // namespace greenloop::offline
