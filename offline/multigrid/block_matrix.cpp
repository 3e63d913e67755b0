#include "offline/multigrid/block_matrix.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <stdexcept>
#include <string>

namespace greenloop::offline {

std::size_t BlockMatrix::bytes() const {
  return sizeof(std::uint32_t) * (start.size() + upper.size() + column.size()) +
         sizeof(DoubleBlock) * (block.size() + diagonal.size());
}

void residual(const BlockMatrix& matrix, std::span<const Double4> b, std::span<const Double4> x, std::span<Double4> r) {
  for (std::uint32_t v = 0; v < matrix.rows(); ++v) {
    Double4 rest = b[v];
    rest -= product(matrix.diagonal[v], x[v]);
    for (std::uint32_t k = matrix.start[v]; k < matrix.start[v + 1]; ++k) {
      rest -= product(matrix.block[k], x[matrix.column[k]]);
    }
    r[v] = rest;
  }
}

double multiply(const BlockMatrix& matrix, std::span<const Double4> x, std::span<Double4> y) {
  Double4 sum{};
  for (std::uint32_t v = 0; v < matrix.rows(); ++v) {
    Double4 row = product(matrix.diagonal[v], x[v]);
    for (std::uint32_t k = matrix.start[v]; k < matrix.start[v + 1]; ++k) {
      row += product(matrix.block[k], x[matrix.column[k]]);
    }
    y[v] = row;
    sum += row * x[v];
  }
  return sum[0] + sum[1] + sum[2];
}

double dot(std::span<const Double4> a, std::span<const Double4> b) {
  Double4 sum{};
  for (std::size_t v = 0; v < a.size(); ++v) sum += a[v] * b[v];
  return sum[0] + sum[1] + sum[2];
}

std::vector<DoubleBlock> inverse_diagonal(const BlockMatrix& matrix) {
  std::vector<DoubleBlock> inverse(matrix.rows());
  for (std::uint32_t v = 0; v < matrix.rows(); ++v) {
    Eigen::Matrix3d block;
    for (int j = 0; j < 3; ++j) {
      for (int i = 0; i < 3; ++i) block(i, j) = matrix.diagonal[v].column[j][i];
    }
    const Eigen::LLT<Eigen::Matrix3d> factor(block);
    if (factor.info() != Eigen::Success) {
      throw std::invalid_argument("multigrid: the block of vertex " + std::to_string(v) +
                                  " is not positive definite; is it part of a body that is held?");
    }
    const Eigen::Matrix3d solved = factor.solve(Eigen::Matrix3d::Identity());
    for (int j = 0; j < 3; ++j) inverse[v].column[j] = Double4{solved(0, j), solved(1, j), solved(2, j), 0.0};
  }
  return inverse;
}

}  // namespace greenloop::offline
