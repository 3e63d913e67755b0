#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "offline/compress/wavelet/surface_wavelet.hpp"

namespace greenloop::offline {

/// What one threshold leaves of a column.
struct ColumnTrial {
  std::size_t kept = 0;     ///< blocks
  double error_energy = 0;  ///< square of the error's Frobenius norm
  double worst = 0;         ///< largest block of the error over the largest of the column
};

struct CompressedColumn {
  double exact_energy = 0;          ///< square of the column's Frobenius norm
  std::vector<ColumnTrial> trials;  ///< by threshold
};

/// The compression of single Green's functions of James & Pai 2003, section 4.5, at several thresholds epsilon: block i
/// of level l >= 1 of the transformed column is dropped if its Frobenius norm is below 2^(l - L) epsilon times the
/// largest block of the untransformed one; base level blocks stay. Offline only.
class ColumnCompression {
 public:
  /// `take(number of the threshold, error of the compressed column)`.
  using TakeError = std::function<void(std::size_t threshold, const std::vector<double>& error)>;

  /// Both must outlive it.
  ColumnCompression(const SurfaceWavelet& wavelet, const std::vector<double>& thresholds);

  /// `column`: a block of 9 numbers per row of the wavelet. Work: a transform, and one back for every threshold.
  [[nodiscard]] CompressedColumn compress(const std::vector<double>& column, const TakeError& take = {}) const;

 private:
  [[nodiscard]] std::vector<double> dropped(const std::vector<double>& coefficients, double threshold,
                                            std::size_t& kept) const;

  const SurfaceWavelet* wavelet_;
  const std::vector<double>* thresholds_;
  std::vector<double> level_share_;  // [row] of epsilon
};

}  // namespace greenloop::offline
