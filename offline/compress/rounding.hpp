#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "offline/compress/column_codec.hpp"
#include "offline/compress/lifted_linear.hpp"

namespace greenloop::offline {

/// The nodal shape of every wavelet (scaling function on the base level): what a unit coefficient adds to each row.
class WaveletShapes {
 public:
  struct Entry {
    std::uint32_t row = 0;
    float value = 0;
  };

  /// Work: a ninth of an inverse transform per row.
  explicit WaveletShapes(const LiftedLinear& wavelet);

  [[nodiscard]] const Entry* begin(std::size_t row) const { return entries_.data() + begin_[row]; }
  [[nodiscard]] const Entry* end(std::size_t row) const { return entries_.data() + begin_[row + 1]; }
  [[nodiscard]] float squared_norm(std::size_t row) const { return squared_norm_[row]; }

 private:
  std::vector<std::size_t> begin_;
  std::vector<Entry> entries_;
  std::vector<float> squared_norm_;
};

/// Moves the quanta of the kept blocks to lower the squared error of the reconstructed column: `sweeps` rounds of
/// coordinate descent, coarse to fine, one coefficient at a time. The wavelets are not orthogonal, so kept coefficients
/// can make up for some of what was dropped and rounded; plain rounding ignores that. `values` is the reconstruction of
/// `encoded` (decode_column), and is not updated. Work: sweeps times the kept wavelets' supports. Offline only.
void refine_quanta(const LiftedLinear& wavelet, const WaveletShapes& shapes, const TransformedColumn& column,
                   const std::vector<std::uint32_t>& value_bytes, const std::vector<float>& values, int sweeps,
                   EncodedColumn& encoded);

}  // namespace greenloop::offline
