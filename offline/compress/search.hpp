#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "offline/compress/column_codec.hpp"
#include "offline/compress/rounding.hpp"

namespace greenloop::offline {

/// The errors a model may have against the exact compliance, both relative and in traction form Xi = U diag(area).
struct Accuracy {
  double rms = 0;           ///< ||Xi^ - Xi||_F / ||Xi||_F
  double worst_column = 0;  ///< max over columns of ||Xi^_j - Xi_j||_inf / ||Xi_j||_inf, block-wise Frobenius
};

/// How the columns of one constraint level are thresholded and quantised.
struct Encoding {
  double epsilon = 0;         ///< threshold at the finest level relative to a typical column's largest block
  double typical_weight = 0;  ///< m^3/N: mean over columns of area times largest block
  std::vector<std::uint32_t> value_bytes;  ///< per row level, 1 or 2
  int sweeps = 0;                          ///< rounds of refine_quanta, 0: plain rounding
};

/// Threshold of one column [m/N]: epsilon times the geometric mean of the column's largest block (which bounds each
/// column's own error) and of the block that weighs typically in the traction form (which bounds the error of all).
[[nodiscard]] double column_threshold(const Encoding& encoding, const TransformedColumn& column);

/// Errors and size of a set of columns.
struct Tally {
  double error_energy = 0, exact_energy = 0;  ///< traction form
  double worst_column = 0;
  std::size_t columns = 0, blocks = 0, bytes = 0;

  [[nodiscard]] double rms() const;
};

/// Codes columns one by one and measures each by reconstructing it as the runtime does.
class ColumnCoder {
 public:
  explicit ColumnCoder(const LiftedLinear& wavelet) : wavelet_(&wavelet), shapes_(wavelet) {}

  /// Codes `column` into `encoded` and adds it to `tally`. A column whose own error exceeds `worst_column` is coded
  /// again with a lower threshold until it holds or nothing more can be kept; returns whether it was.
  bool code(const TransformedColumn& column, const Encoding& encoding, double worst_column, EncodedColumn& encoded,
            Tally& tally);

  /// The tally of all `columns`, nothing kept.
  [[nodiscard]] Tally measure(const std::vector<TransformedColumn>& columns, const Encoding& encoding,
                              double worst_column = std::numeric_limits<double>::infinity());

  /// Bytes of an encoded column in its Blocks sections.
  [[nodiscard]] std::size_t bytes(const EncodedColumn& encoded, const std::vector<std::uint32_t>& value_bytes) const;

  [[nodiscard]] const LiftedLinear& wavelet() const { return *wavelet_; }

 private:
  const LiftedLinear* wavelet_;
  WaveletShapes shapes_;
  std::vector<float> values_;
  EncodedColumn scratch_;
};

/// Mean of area times largest block over `sample`, Encoding::typical_weight.
[[nodiscard]] double typical_weight(const std::vector<TransformedColumn>& sample);

/// The encoding of fewest bytes that meets `accuracy` on `sample`: the largest epsilon by bisection for every number
/// of leading levels stored in 16 bits, at least `wide_levels` of them; then larger yet for what refine_quanta gains.
/// Nothing if even 16 bits and no threshold fail.
[[nodiscard]] std::optional<Encoding> search_encoding(ColumnCoder& coder, const std::vector<TransformedColumn>& sample,
                                                      const Accuracy& accuracy, std::size_t wide_levels);

}  // namespace greenloop::offline
