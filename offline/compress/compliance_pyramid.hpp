#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "offline/compress/column_source.hpp"
#include "offline/compress/linear_wavelet.hpp"
#include "offline/compress/scale.hpp"

namespace greenloop::offline {

/// A symmetric compliance in single precision, 3x3 blocks by columns: block (i, j) is 9 numbers, 3 c + r.
class DenseCompliance {
 public:
  explicit DenseCompliance(std::size_t rows) : rows_(rows), values_(9 * rows * rows, 0.0F) {}
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

/// Couplings between the coefficients of a level and of one partner that may be worth storing; scaled, block-sparse by
/// columns.
struct CouplingCandidates {
  std::size_t rows = 0;
  std::vector<std::size_t> begin = {0};  ///< columns + 1
  std::vector<std::uint32_t> row;        ///< increasing within a column
  std::vector<float> norm;               ///< Frobenius norm of the scaled block over root 3, at least the floor
  std::vector<float> value;              ///< 9 per block, 3 c + r
};

/// The compliance of the domain nodes in the two-sided non-standard wavelet form of formats/layout.hpp (Beylkin,
/// Coifman and Rokhlin 1991), without what is too small to matter.
struct CompliancePyramid {
  struct Level {
    std::vector<CoefficientScale> details;      ///< level 0: empty
    std::vector<CoefficientScale> averages;     ///< empty above level max(L-2, 0)
    std::array<CouplingCandidates, 3> partner;  ///< by layout::Partner
  };
  std::vector<Level> levels;
  std::vector<DenseCompliance> coarse;  ///< exact compliance between the averages of level q, q = 0..L-1
};

/// Streams the exact columns, one per domain node, once and in order, and keeps couplings of norm `floor` and more,
/// scaled by the coefficients' own diagonal blocks. Memory: the columns of K(L-1) in single precision, a quarter of the
/// dense matrix, besides the result. Throws std::invalid_argument if columns are not finite or a diagonal block is not
/// positive definite. Offline only.
[[nodiscard]] CompliancePyramid build_pyramid(const LinearWavelet& wavelet, const ColumnSource& columns, double floor,
                                              const Progress& progress);

}  // namespace greenloop::offline
