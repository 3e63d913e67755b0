#pragma once

#include <cstdint>
#include <span>

#include "runtime/algebra/block.hpp"

namespace greenloop {

/// One level of a multigrid hierarchy, read in place: a symmetric positive definite operator in rows of 3x3 blocks, a
/// row a vertex, and the interpolation of its vertices from those of the next coarser level (Georgii & Westermann 2005,
/// section 3.2). Fourth lanes are 0.
struct MultigridLevel {
  std::span<const std::uint32_t> start;   ///< [vertices + 1], of each row's blocks beside the diagonal
  std::span<const std::uint32_t> upper;   ///< [vertices], the first of them right of the diagonal
  std::span<const std::uint32_t> column;  ///< of each block, ascending in a row
  std::span<const Block<3>> block;        ///< beside the diagonal
  std::span<const Block<3>> inverse;      ///< [vertices], of the blocks on the diagonal

  std::span<const std::uint32_t> parent_start;  ///< [vertices + 1]
  std::span<const std::uint32_t> parent;        ///< vertices of the next coarser level
  std::span<const float> weight;                ///< of each parent

  [[nodiscard]] std::uint32_t vertices() const { return static_cast<std::uint32_t>(inverse.size()); }
};

/// Cholesky factor of the coarsest level's operator, in double precision: stiff parts of soft bodies leave single
/// precision nothing of their rigid motions.
struct CoarsestFactor {
  std::uint32_t vertices = 0;
  /// Rows of L one after another, 1, 2, .. 3 vertices numbers each, with inverses on the diagonal.
  std::span<const double> lower;
};

}  // namespace greenloop
