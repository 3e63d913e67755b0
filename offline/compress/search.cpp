#include "offline/compress/search.hpp"

#include <algorithm>
#include <cmath>

namespace greenloop::offline {
namespace {

constexpr double log2_epsilon_least = -20, log2_epsilon_most = 2;
constexpr int bisections = 12;         // to 0.4 % of epsilon
constexpr int refined_bisections = 6;  // of one octave: to 1 %
constexpr int refined_sweeps = 2;

bool meets(const Tally& tally, const Accuracy& accuracy) {
  return tally.rms() <= accuracy.rms && tally.worst_column <= accuracy.worst_column;
}

std::vector<std::uint32_t> leading_wide(std::size_t levels, std::size_t wide) {
  std::vector<std::uint32_t> value_bytes(levels, 1);
  std::fill_n(value_bytes.begin(), wide, 2);
  return value_bytes;
}

struct Candidate {
  Encoding encoding;
  std::size_t bytes = 0;
};

/// The largest epsilon that meets `accuracy` with the value bytes of `encoding`.
std::optional<Candidate> bisect_epsilon(ColumnCoder& coder, const std::vector<TransformedColumn>& sample,
                                        const Accuracy& accuracy, Encoding encoding) {
  double low = log2_epsilon_least, high = log2_epsilon_most;
  encoding.epsilon = std::exp2(low);
  auto tally = coder.measure(sample, encoding, accuracy.worst_column);
  if (!meets(tally, accuracy)) return std::nullopt;
  std::size_t bytes = tally.bytes;
  for (int i = 0; i < bisections; ++i) {
    const double middle = 0.5 * (low + high);
    encoding.epsilon = std::exp2(middle);
    tally = coder.measure(sample, encoding, accuracy.worst_column);
    const bool met = meets(tally, accuracy);
    (met ? low : high) = middle;
    if (met) bytes = tally.bytes;
  }
  encoding.epsilon = std::exp2(low);
  return Candidate{encoding, bytes};
}

/// Spends what better rounding gains on a larger epsilon: up to twice the one that plain rounding needs.
Encoding refine_epsilon(ColumnCoder& coder, const std::vector<TransformedColumn>& sample, const Accuracy& accuracy,
                        Encoding encoding) {
  encoding.sweeps = refined_sweeps;
  double low = std::log2(encoding.epsilon);
  double high = low + 1.0;
  for (int i = 0; i < refined_bisections; ++i) {
    const double middle = 0.5 * (low + high);
    encoding.epsilon = std::exp2(middle);
    (meets(coder.measure(sample, encoding, accuracy.worst_column), accuracy) ? low : high) = middle;
  }
  encoding.epsilon = std::exp2(low);
  return encoding;
}

}  // namespace

double column_threshold(const Encoding& encoding, const TransformedColumn& column) {
  return encoding.epsilon * std::sqrt(column.largest * encoding.typical_weight / column.area);
}

double Tally::rms() const { return exact_energy > 0 ? std::sqrt(error_energy / exact_energy) : 0.0; }

bool ColumnCoder::code(const TransformedColumn& column, const Encoding& encoding, double worst_column,
                       EncodedColumn& encoded, Tally& tally) {
  double threshold = column_threshold(encoding, column);
  const double least = std::exp2(log2_epsilon_least) * column.largest;
  bool tightened = false;
  ColumnError error;
  while (true) {
    encode_column(*wavelet_, column, threshold, encoding.value_bytes, encoded);
    decode_column(*wavelet_, encoded, values_);
    if (encoding.sweeps > 0) {
      refine_quanta(*wavelet_, shapes_, column, encoding.value_bytes, values_, encoding.sweeps, encoded);
      decode_column(*wavelet_, encoded, values_);
    }
    error = column_error(column, values_);
    if (error.largest <= worst_column || threshold <= least) break;
    threshold *= std::clamp(worst_column / error.largest, 0.5, 0.95);
    tightened = true;
  }
  tally.error_energy += error.energy * column.area * column.area;
  tally.exact_energy += column.energy * column.area * column.area;
  tally.worst_column = std::max(tally.worst_column, error.largest);
  tally.columns += 1;
  tally.blocks += encoded.blocks();
  tally.bytes += bytes(encoded, encoding.value_bytes);
  return tightened;
}

Tally ColumnCoder::measure(const std::vector<TransformedColumn>& columns, const Encoding& encoding,
                           double worst_column) {
  Tally tally;
  for (const auto& column : columns) code(column, encoding, worst_column, scratch_, tally);
  return tally;
}

std::size_t ColumnCoder::bytes(const EncodedColumn& encoded, const std::vector<std::uint32_t>& value_bytes) const {
  std::size_t sum = 0;
  for (std::size_t l = 0; l < encoded.levels.size(); ++l) {
    const std::size_t rows = wavelet_->row_begin(l + 1) - wavelet_->row_begin(l);
    const std::size_t index_bytes = l == 0 ? 0 : (rows <= 0x10000 ? 2 : 4);
    const std::size_t block_bytes = LiftedLinear::components * value_bytes[l] + index_bytes;
    sum += sizeof(std::uint32_t) + sizeof(float) + encoded.levels[l].rows.size() * block_bytes;
  }
  return sum;
}

double typical_weight(const std::vector<TransformedColumn>& sample) {
  double sum = 0;
  for (const auto& column : sample) sum += column.area * column.largest;
  return sample.empty() ? 0.0 : sum / static_cast<double>(sample.size());
}

std::optional<Encoding> search_encoding(ColumnCoder& coder, const std::vector<TransformedColumn>& sample,
                                        const Accuracy& accuracy, std::size_t wide_levels) {
  const std::size_t levels = coder.wavelet().levels();
  std::optional<Candidate> best;
  for (std::size_t wide = wide_levels; wide <= levels; ++wide) {
    const Encoding start{0.0, typical_weight(sample), leading_wide(levels, wide)};
    const auto candidate = bisect_epsilon(coder, sample, accuracy, start);
    if (!candidate) continue;
    if (best && candidate->bytes >= best->bytes) break;  // more bits only cost from here on
    best = candidate;
  }
  if (!best) return std::nullopt;
  return refine_epsilon(coder, sample, accuracy, best->encoding);
}

}  // namespace greenloop::offline
