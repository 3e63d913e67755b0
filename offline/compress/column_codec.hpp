#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "offline/compress/lifted_linear.hpp"

namespace greenloop::offline {

/// Exact columns [first, first + count) in force form (m/N): 3 rows per domain node in node order, 3 columns per force.
using ColumnSource = std::function<Eigen::MatrixXd(std::size_t first, std::size_t count)>;

/// One Green's function in the rows of a LiftedLinear: nodal values and their wavelet coefficients.
struct TransformedColumn {
  std::vector<float> values;        ///< (rows + 1) * 9, m/N; block element 3 c + r = displacement r per force c
  std::vector<float> coefficients;  ///< the same shape
  std::vector<float> norms;         ///< [rows] Frobenius norms of the coefficients' blocks
  double energy = 0;                ///< sum of squares of the values
  double largest = 0;               ///< largest Frobenius norm of a block of the values
  double area = 0;                  ///< m^2, turns force form into traction form
  std::vector<std::size_t> near;    ///< rows that are kept whatever their norm, increasing
};

/// Column `j` of `block` (3 rows() x 3 per column), transformed in double precision; `near_nodes` (increasing) become
/// the rows that are always kept. Work: linear in the rows.
[[nodiscard]] TransformedColumn transform_column(const LiftedLinear& wavelet, const Eigen::MatrixXd& block,
                                                 std::size_t j, double area,
                                                 const std::vector<std::size_t>& near_nodes = {});

/// One column as the model file stores it.
struct EncodedColumn {
  struct Level {
    float scale = 0;                   ///< m/N per quantum
    std::vector<std::uint32_t> rows;   ///< within the level's domain nodes, increasing; every row on level 0
    std::vector<std::int16_t> values;  ///< 9 per row
  };
  std::vector<Level> levels;

  [[nodiscard]] std::size_t blocks() const;
};

/// Keeps the blocks of level l > 0 whose norm is at least 2^(l - L) * `threshold` (m/N), those of near rows (without
/// them a node's own details vanish where the body is stiffer than elsewhere, and a small contact patch becomes
/// singular), and the whole base level, and
/// rounds them to value_bytes[l] (1: +-127, 2: +-32767) at one scale per level (James & Pai 2003, section 4.5).
/// Work: linear in the rows. Offline only.
void encode_column(const LiftedLinear& wavelet, const TransformedColumn& column, double threshold,
                   const std::vector<std::uint32_t>& value_bytes, EncodedColumn& encoded);

/// Dequantises and reconstructs in single precision with the runtime's operations. `values` becomes (rows + 1) * 9.
void decode_column(const LiftedLinear& wavelet, const EncodedColumn& encoded, std::vector<float>& values);

/// How far `values` is from the exact column.
struct ColumnError {
  double energy = 0;   ///< sum of squares of the difference
  double largest = 0;  ///< largest Frobenius norm of a block of the difference, relative to the column's largest block
};
[[nodiscard]] ColumnError column_error(const TransformedColumn& exact, const std::vector<float>& values);

}  // namespace greenloop::offline
