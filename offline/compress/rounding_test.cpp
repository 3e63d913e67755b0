#include "offline/compress/rounding.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "offline/compress/test_body.hpp"

namespace greenloop::offline {
namespace {

constexpr std::size_t width = LiftedLinear::components;

struct Fixture {
  test::Body body = test::make_body(3);
  LiftedLinear wavelet{body.mesh, body.flags, body.area};
  WaveletShapes shapes{wavelet};

  [[nodiscard]] TransformedColumn column(std::size_t j) const {
    return transform_column(wavelet, body.compliance, j, body.area[body.column_nodes[j]]);
  }
};

const Fixture& fixture() {
  static const Fixture value;
  return value;
}

TEST_CASE("shapes are what the inverse transform makes of a unit coefficient") {
  const auto& f = fixture();
  for (const std::size_t row : {std::size_t{0}, f.wavelet.row_begin(1), f.wavelet.row_begin(3) + 5}) {
    std::vector<double> x((f.wavelet.rows() + 1) * width, 0.0);
    x[width * row] = 1.0;
    f.wavelet.inverse(x.data());
    double squared = 0, covered = 0;
    for (std::size_t i = 0; i < f.wavelet.rows(); ++i) squared += x[width * i] * x[width * i];
    for (const auto* entry = f.shapes.begin(row); entry != f.shapes.end(row); ++entry) {
      CHECK(entry->value == static_cast<float>(x[width * entry->row]));
      covered += x[width * entry->row] * x[width * entry->row];
    }
    CHECK(covered == squared);
    CHECK(static_cast<double>(f.shapes.squared_norm(row)) == doctest::Approx(squared).epsilon(1e-6));
  }
}

TEST_CASE("refined quanta keep the same blocks within their range and lower the squared error") {
  const auto& f = fixture();
  const std::vector<std::uint32_t> value_bytes(4, 1);
  double plain = 0, once = 0, twice = 0;
  for (std::size_t j = 0; j < f.body.column_nodes.size(); j += 31) {
    const auto column = f.column(j);
    EncodedColumn encoded;
    std::vector<float> values;
    encode_column(f.wavelet, column, 0.05 * column.largest, value_bytes, encoded);
    decode_column(f.wavelet, encoded, values);
    const double before = column_error(column, values).energy;
    const std::size_t blocks = encoded.blocks();
    plain += before;
    auto again = encoded;
    refine_quanta(f.wavelet, f.shapes, column, value_bytes, values, 1, encoded);
    refine_quanta(f.wavelet, f.shapes, column, value_bytes, values, 2, again);
    CHECK(encoded.blocks() == blocks);
    for (const auto& level : encoded.levels) {
      for (const auto value : level.values) CHECK(std::abs(int{value}) <= 127);
    }
    decode_column(f.wavelet, encoded, values);
    const double after = column_error(column, values).energy;
    CHECK(after < before);
    once += after;
    decode_column(f.wavelet, again, values);
    twice += column_error(column, values).energy;
  }
  CHECK(once < 0.95 * plain);
  CHECK(twice < once);
}

TEST_CASE("a reconstruction without error is left alone") {
  const auto& f = fixture();
  auto column = f.column(60);
  EncodedColumn encoded;
  encode_column(f.wavelet, column, 0.1 * column.largest, {1, 1, 1, 1}, encoded);
  decode_column(f.wavelet, encoded, column.values);
  const auto before = encoded;
  refine_quanta(f.wavelet, f.shapes, column, {1, 1, 1, 1}, column.values, 2, encoded);
  for (std::size_t l = 0; l < 4; ++l) CHECK(encoded.levels[l].values == before.levels[l].values);
}

}  // namespace
}  // namespace greenloop::offline
