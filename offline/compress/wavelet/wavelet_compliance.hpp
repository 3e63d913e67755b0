#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "offline/compress/wavelet/exact_columns.hpp"
#include "offline/compress/wavelet/scale.hpp"
#include "offline/compress/wavelet/surface_wavelet.hpp"
#include "offline/progress.hpp"

namespace greenloop::offline {

/// A matrix of 3x3 blocks in single precision, by columns: block (i, j) is 9 numbers, 3 c + r.
class BlockMatrix {
 public:
  explicit BlockMatrix(std::size_t rows) : rows_(rows), values_(9 * rows * rows, 0.0F) {}
  [[nodiscard]] std::size_t rows() const { return rows_; }
  [[nodiscard]] float* column(std::size_t j) { return values_.data() + 9 * rows_ * j; }
  [[nodiscard]] const float* column(std::size_t j) const { return values_.data() + 9 * rows_ * j; }
  [[nodiscard]] Eigen::Matrix3d block(std::size_t i, std::size_t j) const {
    return Eigen::Map<const Eigen::Matrix3f>(column(j) + 9 * i).cast<double>();
  }

 private:
  std::size_t rows_;
  std::vector<float> values_;
};

/// Couplings of the coefficients of a level with those before them that may be worth storing; block-sparse by columns.
struct CouplingCandidates {
  std::vector<std::size_t> begin = {0};  ///< columns + 1
  std::vector<std::uint32_t> row;        ///< among all coefficients, increasing within a column, before the column's
  std::vector<float> norm;               ///< Frobenius norm of the scaled block over root 3
  std::vector<float> value;              ///< 9 per block, 3 c + r; scaled
};

/// The compliance of the domain nodes in the two-sided wavelet form of formats/layout.hpp, W U W^T, without what is too
/// small to matter.
struct WaveletCompliance {
  std::vector<CoefficientScale> scales;       ///< by coefficient
  std::vector<CouplingCandidates> couplings;  ///< by level of the column
  BlockMatrix coarse{0};  ///< W U W^T between the coefficients of levels 0..L-1 (of level 0 if L = 0)
};

/// Streams the exact columns, one per domain node, once and in order, and keeps couplings of norm `floor` and more
/// relative to the coefficients' own diagonal blocks. Memory: the columns of K(L-1) in single precision, a quarter of
/// the dense matrix, and `coarse`, a sixteenth, besides the result. Throws std::invalid_argument if columns are not
/// finite or the compliance is not positive definite. Offline only.
[[nodiscard]] WaveletCompliance transform_compliance(const SurfaceWavelet& wavelet, const ExactColumns& columns,
                                                     double floor, const Progress& progress);

/// Block column j of the exact compliance between the averages of `level` < L (or of level 0 if L = 0): row_end(level)
/// blocks of 9 numbers, 3 c + r, m/N. Work: a column of `coarse` for each coefficient that node j reaches.
[[nodiscard]] std::vector<double> exact_column(const SurfaceWavelet& wavelet, const WaveletCompliance& compliance,
                                               std::size_t level, std::size_t j);

}  // namespace greenloop::offline
