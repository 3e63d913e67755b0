#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace greenloop::offline {

/// Three numbers of a vertex and a fourth that is 0.
using Double4 = double __attribute__((vector_size(32)));
using BlockVector = std::vector<Double4>;

/// A 3x3 block by columns.
struct DoubleBlock {
  Double4 column[3];
};

inline Double4 splat(double value) { return Double4{value, value, value, value}; }

inline Double4 product(const DoubleBlock& block, const Double4& x) {
  return (block.column[0] * splat(x[0]) + block.column[1] * splat(x[1])) + block.column[2] * splat(x[2]);
}

/// A symmetric matrix in rows of 3x3 blocks, both triangles.
struct BlockMatrix {
  std::vector<std::uint32_t> start;   ///< [rows + 1], of the blocks beside the diagonal
  std::vector<std::uint32_t> upper;   ///< [rows], the first of them right of the diagonal
  std::vector<std::uint32_t> column;  ///< ascending in a row
  std::vector<DoubleBlock> block;
  std::vector<DoubleBlock> diagonal;  ///< [rows]

  [[nodiscard]] std::uint32_t rows() const { return static_cast<std::uint32_t>(diagonal.size()); }
  [[nodiscard]] std::size_t bytes() const;
};

/// b - matrix x. Work: every block once.
void residual(const BlockMatrix& matrix, std::span<const Double4> b, std::span<const Double4> x, std::span<Double4> r);
/// y = matrix x; returns x . y. Work: every block once.
double multiply(const BlockMatrix& matrix, std::span<const Double4> x, std::span<Double4> y);

[[nodiscard]] double dot(std::span<const Double4> a, std::span<const Double4> b);

/// The inverse of each block on the diagonal. Throws std::invalid_argument naming the row of one that is not positive
/// definite.
[[nodiscard]] std::vector<DoubleBlock> inverse_diagonal(const BlockMatrix& matrix);

}  // namespace greenloop::offline
