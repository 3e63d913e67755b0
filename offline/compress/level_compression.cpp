#include "offline/compress/level_compression.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace greenloop::offline {
namespace {

constexpr std::size_t block_columns = 64;  // streamed at a time
constexpr int passes = 6;

void append(const EncodedColumn& encoded, std::vector<BlocksData>& blocks) {
  for (std::size_t r = 0; r < blocks.size(); ++r) {
    const auto& level = encoded.levels[r];
    auto& data = blocks[r];
    data.scale.push_back(level.scale);
    data.value.insert(data.value.end(), level.values.begin(), level.values.end());
    if (!data.dense) data.index.insert(data.index.end(), level.rows.begin(), level.rows.end());
    data.begin.push_back(static_cast<std::uint32_t>(data.value.size() / LiftedLinear::components));
  }
}

CompressedLevel code_all(ColumnCoder& coder, const ConstraintLevel& level, const ColumnSource& source,
                         const Encoding& encoding, const Accuracy& accuracy, const Progress& progress) {
  CompressedLevel result;
  result.encoding = encoding;
  result.blocks.resize(coder.wavelet().levels());
  for (std::size_t r = 0; r < result.blocks.size(); ++r) {
    result.blocks[r].value_bytes = encoding.value_bytes[r];
    result.blocks[r].dense = r == 0;
    result.blocks[r].begin = {0};
  }
  EncodedColumn encoded;
  for (std::size_t first = 0; first < level.columns.size(); first += block_columns) {
    const std::size_t count = std::min(block_columns, level.columns.size() - first);
    const Eigen::MatrixXd block = source(first, count);
    for (std::size_t j = 0; j < count; ++j) {
      const double area = static_cast<double>(level.columns[first + j].area);
      const auto column = transform_column(coder.wavelet(), block, j, area, level.near[first + j]);
      if (coder.code(column, encoding, accuracy.worst_column, encoded, result.tally)) ++result.tightened;
      append(encoded, result.blocks);
    }
    progress(static_cast<double>(first + count) / static_cast<double>(level.columns.size()), "code columns");
  }
  return result;
}

[[noreturn]] void unreachable_accuracy(const ConstraintLevel& level, const Accuracy& accuracy) {
  throw std::runtime_error("compression: constraint level " + std::to_string(level.level) +
                           " cannot be stored with an RMS error of " + std::to_string(accuracy.rms) +
                           " and a worst-column error of " + std::to_string(accuracy.worst_column) +
                           " even in 16 bits without a threshold; ask for larger errors");
}

}  // namespace

std::vector<TransformedColumn> sample_columns(const LiftedLinear& wavelet, const ConstraintLevel& level,
                                              const ColumnSource& source, std::size_t count) {
  const std::size_t total = level.columns.size();
  count = std::min(count, total);
  std::vector<TransformedColumn> sample;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t j = i * total / count;
    sample.push_back(
        transform_column(wavelet, source(j, 1), 0, static_cast<double>(level.columns[j].area), level.near[j]));
  }
  return sample;
}

CompressedLevel compress_level(ColumnCoder& coder, const ConstraintLevel& level, const ColumnSource& source,
                               const std::vector<TransformedColumn>& sample, const Accuracy& accuracy,
                               const Progress& progress) {
  Accuracy aim = accuracy;  // on the sample, corrected by what all columns show
  std::size_t wide_levels = 0;
  CompressedLevel best;
  for (int pass = 0; pass < passes; ++pass) {
    const auto encoding = search_encoding(coder, sample, aim, wide_levels);
    if (!encoding) break;
    // how many passes there will be is not known: each gets half of what is left of the bar
    const Progress halved = [&](double fraction, std::string_view stage) {
      progress(1.0 - std::ldexp(1.0 - 0.5 * fraction, -pass), stage);
    };
    auto coded = code_all(coder, level, source, *encoding, accuracy, halved);
    const double rms = coded.tally.rms();
    if (coded.tally.worst_column > accuracy.worst_column) {
      ++wide_levels;  // some column outside the sample needs finer quanta
      continue;
    }
    const bool met = rms <= accuracy.rms;
    if (met && (best.blocks.empty() || coded.tally.bytes < best.tally.bytes)) best = std::move(coded);
    const bool close = rms >= 0.98 * accuracy.rms || sample.size() == level.columns.size();
    if (met && (close || pass > 0)) break;
    aim.rms *= accuracy.rms / rms * 0.997;
  }
  if (best.blocks.empty()) unreachable_accuracy(level, accuracy);
  progress(1.0, "code columns");
  return best;
}

}  // namespace greenloop::offline
