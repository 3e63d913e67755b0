#include "offline/compress/search.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <utility>

#include "offline/compress/test_body.hpp"

namespace greenloop::offline {
namespace {

struct Fixture {
  test::Body body = test::make_body(3);
  LiftedLinear wavelet{body.mesh, body.flags, body.area};
  std::vector<TransformedColumn> sample = [this] {
    std::vector<TransformedColumn> columns;
    for (std::size_t j = 0; j < body.column_nodes.size(); j += 9) {
      columns.push_back(transform_column(wavelet, body.compliance, j, body.area[body.column_nodes[j]]));
    }
    return columns;
  }();
};

const Fixture& fixture() {
  static const Fixture value;
  return value;
}

TEST_CASE("the tally measures traction-form errors") {
  const auto& f = fixture();
  ColumnCoder coder(f.wavelet);
  const Encoding encoding{0.1, typical_weight(f.sample), {1, 1, 1, 1}};
  const auto tally = coder.measure(f.sample, encoding);
  double error = 0, exact = 0, worst = 0;
  std::size_t blocks = 0;
  for (const auto& column : f.sample) {
    EncodedColumn encoded;
    std::vector<float> values;
    encode_column(f.wavelet, column, column_threshold(encoding, column), encoding.value_bytes, encoded);
    decode_column(f.wavelet, encoded, values);
    double largest = 0;
    for (std::size_t i = 0; i < f.wavelet.rows(); ++i) {
      double block = 0;
      for (std::size_t k = 9 * i; k < 9 * i + 9; ++k) {
        const double d = (static_cast<double>(values[k]) - static_cast<double>(column.values[k])) * column.area;
        const double x = static_cast<double>(column.values[k]) * column.area;
        block += d * d;
        exact += x * x;
      }
      error += block;
      largest = std::max(largest, std::sqrt(block));
    }
    worst = std::max(worst, largest / (column.area * column.largest));
    blocks += encoded.blocks();
  }
  CHECK(tally.rms() == doctest::Approx(std::sqrt(error / exact)).epsilon(1e-9));
  CHECK(tally.worst_column == doctest::Approx(worst).epsilon(1e-9));
  CHECK(tally.blocks == blocks);
  CHECK(tally.columns == f.sample.size());
  CHECK(tally.rms() > 0.005);
}

TEST_CASE("a larger epsilon keeps fewer blocks and errs more") {
  const auto& f = fixture();
  ColumnCoder coder(f.wavelet);
  Tally finer;
  for (const double epsilon : {0.01, 0.03, 0.1, 0.3}) {
    const auto tally = coder.measure(f.sample, {epsilon, typical_weight(f.sample), {2, 2, 2, 2}});
    if (finer.columns > 0) {
      CHECK(tally.blocks < finer.blocks);
      CHECK(tally.bytes < finer.bytes);
      CHECK(tally.rms() > finer.rms());
    }
    finer = tally;
  }
}

TEST_CASE("the search meets its targets and leaves nothing on the table") {
  const auto& f = fixture();
  ColumnCoder coder(f.wavelet);
  for (const double rms : {0.05, 0.02, 0.003}) {
    CAPTURE(rms);
    const Accuracy accuracy{rms, 1.0};
    const auto found = search_encoding(coder, f.sample, accuracy, 0);
    REQUIRE(found.has_value());
    const auto tally = coder.measure(f.sample, *found, accuracy.worst_column);
    CHECK(tally.rms() <= rms);
    auto looser = *found;
    looser.epsilon *= 1.05;
    CHECK(coder.measure(f.sample, looser, accuracy.worst_column).rms() > rms);
    if (rms < 0.004) CHECK(found->value_bytes[0] == 2);  // one part in 127 is not enough for the base level
    if (rms > 0.04) CHECK(found->value_bytes == std::vector<std::uint32_t>{1, 1, 1, 1});
  }
}

/// Bytes per column at an RMS error of 3 % when a column's threshold is epsilon times
/// largest^(1 - balance) * (typical weight / area)^balance, and the worst column's error there.
struct RuleResult {
  double bytes = 0, blocks = 0, worst_column = 0;
};
RuleResult bytes_at_three_percent(const Fixture& f, double balance) {
  ColumnCoder coder(f.wavelet);
  const double weight = typical_weight(f.sample);
  double low = 1e-4, high = 4.0;
  Tally met;
  for (int i = 0; i < 24; ++i) {
    const double epsilon = std::sqrt(low * high);
    Tally tally;
    EncodedColumn encoded;
    for (const auto& column : f.sample) {
      // the coder's own rule is the one with balance one half: choose its epsilon to get the threshold wanted
      Encoding encoding{1.0, weight, {1, 1, 1, 1}};
      const double wanted = epsilon * std::pow(column.largest, 1.0 - balance) * std::pow(weight / column.area, balance);
      encoding.epsilon = wanted / column_threshold(encoding, column);
      coder.code(column, encoding, 1e9, encoded, tally);
    }
    const bool fits = tally.rms() <= 0.03;
    (fits ? low : high) = epsilon;
    if (fits) met = tally;
  }
  const auto columns = static_cast<double>(f.sample.size());
  return {static_cast<double>(met.bytes) / columns, static_cast<double>(met.blocks) / columns, met.worst_column};
}

TEST_CASE("the threshold between column and whole needs fewer bytes than the column's own largest block") {
  const auto& f = fixture();
  const auto column_rule = bytes_at_three_percent(f, 0.0);
  const auto between = bytes_at_three_percent(f, 0.5);
  const auto whole_rule = bytes_at_three_percent(f, 1.0);
  using Named = std::pair<std::string, RuleResult>;
  for (const auto& [name, result] : {Named{"column", column_rule}, {"between", between}, {"whole", whole_rule}}) {
    MESSAGE(name << ": " << result.blocks << " blocks, " << result.bytes << " bytes per column, worst column "
                 << result.worst_column);
  }
  CHECK(between.bytes < column_rule.bytes);
  CHECK(between.worst_column < whole_rule.worst_column);
}

TEST_CASE("single columns are coded more finely until each holds the worst-column error") {
  const auto& f = fixture();
  ColumnCoder coder(f.wavelet);
  const Encoding encoding{0.5, typical_weight(f.sample), {1, 1, 1, 1}};
  const auto loose = coder.measure(f.sample, encoding);
  REQUIRE(loose.worst_column > 0.2);
  const auto tight = coder.measure(f.sample, encoding, 0.1);
  CHECK(tight.worst_column <= 0.1);
  CHECK(tight.blocks > loose.blocks);
}

TEST_CASE("an accuracy beyond 16 bits is not promised") {
  const auto& f = fixture();
  ColumnCoder coder(f.wavelet);
  CHECK_FALSE(search_encoding(coder, f.sample, {1e-7, 1.0}, 0).has_value());
  CHECK_FALSE(search_encoding(coder, f.sample, {1.0, 1e-7}, 0).has_value());
}

}  // namespace
}  // namespace greenloop::offline
