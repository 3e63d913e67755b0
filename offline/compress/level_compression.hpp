#pragma once

#include <functional>
#include <string_view>
#include <vector>

#include "formats/writer.hpp"
#include "offline/compress/hierarchy.hpp"
#include "offline/compress/search.hpp"

namespace greenloop::offline {

/// Called with the fraction done (0..1) and the stage's name.
using Progress = std::function<void(double, std::string_view)>;

/// What compressing one constraint level gave; the errors and counts are over all of its columns.
struct CompressedLevel {
  Encoding encoding;
  Tally tally;
  std::size_t tightened = 0;       ///< columns whose threshold was lowered to hold the worst-column error
  std::vector<BlocksData> blocks;  ///< one per row level
};

/// Evenly spaced columns of a constraint level, at most `count`.
[[nodiscard]] std::vector<TransformedColumn> sample_columns(const LiftedLinear& wavelet, const ConstraintLevel& level,
                                                            const ColumnSource& source, std::size_t count);

/// Finds the encoding on `sample`, codes every column by streaming `source` and measures it, and searches again from
/// what was measured until `accuracy` holds on all columns. Throws std::runtime_error naming level, request and what
/// was reached if it cannot. Memory: the sample and the result. Work: up to 6 passes over the columns.
[[nodiscard]] CompressedLevel compress_level(ColumnCoder& coder, const ConstraintLevel& level,
                                             const ColumnSource& source, const std::vector<TransformedColumn>& sample,
                                             const Accuracy& accuracy, const Progress& progress);

}  // namespace greenloop::offline
