#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "offline/compress/wavelet/exact_columns.hpp"
#include "offline/compress/wavelet/scale.hpp"
#include "offline/compress/wavelet/surface_wavelet.hpp"
#include "offline/progress.hpp"

namespace greenloop::offline {

/// A matrix of NxN blocks in single precision, by columns: block (i, j) is N N numbers, N c + r.
template <unsigned N>
class BlockMatrix {
 public:
  explicit BlockMatrix(std::size_t rows) : rows_(rows), values_(block_numbers<N> * rows * rows, 0.0F) {}
  [[nodiscard]] std::size_t rows() const { return rows_; }
  [[nodiscard]] float* column(std::size_t j) { return values_.data() + block_numbers<N> * rows_ * j; }
  [[nodiscard]] const float* column(std::size_t j) const { return values_.data() + block_numbers<N> * rows_ * j; }
  [[nodiscard]] SquareMatrix<N> block(std::size_t i, std::size_t j) const {
    return Eigen::Map<const SquareMatrixF<N>>(column(j) + block_numbers<N> * i).template cast<double>();
  }

 private:
  std::size_t rows_;
  std::vector<float> values_;
};

/// Couplings of the coefficients of a level with those before them that may be worth storing; block-sparse by columns.
template <unsigned N>
struct CouplingCandidates {
  std::vector<std::size_t> begin = {0};  ///< columns + 1
  std::vector<std::uint32_t> row;        ///< among all coefficients, increasing within a column, before the column's
  std::vector<float> norm;               ///< Frobenius norm of the scaled block over root N
  std::vector<float> value;              ///< N N per block, N c + r; scaled
};

/// The compliance of the domain nodes in the two-sided wavelet form of formats/layout.hpp, W U W^T, without what is too
/// small to matter. N: numbers of a node, 1 or 3.
template <unsigned N>
struct WaveletCompliance {
  std::vector<CoefficientScale<N>> scales;       ///< by coefficient
  std::vector<CouplingCandidates<N>> couplings;  ///< by level of the column
  BlockMatrix<N> coarse{0};  ///< W U W^T between the coefficients of levels 0..L-1 (of level 0 if L = 0)
};

/// Streams the exact columns, one per domain node, once and in order, and keeps couplings of norm `floor` and more
/// relative to the coefficients' own diagonal blocks. Memory: the columns of K(L-1) in single precision, a quarter of
/// the dense matrix, and `coarse`, a sixteenth, besides the result. Throws std::invalid_argument if columns are not
/// finite or the compliance is not positive definite, or if the wavelet predicts with 3x3 weights and N is 1. Offline
/// only.
template <unsigned N>
[[nodiscard]] WaveletCompliance<N> transform_compliance(const SurfaceWavelet& wavelet, const ExactColumns& columns,
                                                        double floor, const Progress& progress);

/// Block column j of the exact compliance between the averages of `level` < L (or of level 0 if L = 0): row_end(level)
/// blocks of N N numbers, N c + r, m/N. Work: a column of `coarse` for each coefficient that node j reaches.
template <unsigned N>
[[nodiscard]] std::vector<double> exact_column(const SurfaceWavelet& wavelet, const WaveletCompliance<N>& compliance,
                                               std::size_t level, std::size_t j);

}  // namespace greenloop::offline
