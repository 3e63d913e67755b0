#pragma once

#include <cstdint>

#include "runtime/float4.hpp"

namespace greenloop {

/// Order of the padded matrix: whole vectors.
constexpr std::uint32_t padded_order(std::uint32_t order) { return (order + 3) / 4 * 4; }

/// Work units of cholesky_factor: multiply-adds of the elimination, and two passes for padding and scaling.
constexpr std::uint64_t cholesky_factor_work(std::uint32_t order) {
  const std::uint64_t n = padded_order(order);
  return n * (n + 4) * (n + 8) / 6 + 2 * n * n;
}

/// Work units of cholesky_solve.
constexpr std::uint64_t cholesky_solve_work(std::uint32_t order) {
  const std::uint64_t n = padded_order(order);
  return n * n + n;
}

/// Square-root-free Cholesky factors, A = L D L^T, in place, in a fixed order of operations (Golub & Van Loan, Matrix
/// Computations, section 4.1, in panels of four columns).
/// a: [n * n / 4] by columns, n = padded_order(order), 16-byte aligned; only the lower triangle of the matrix is read,
/// and what stands in the padding is ignored. On success it holds L below the diagonal and the inverse of D on it.
/// False if a pivot is not finite, or not above the rounding error of the diagonal entry that it is left of: then the
/// matrix is not positive definite to working precision. For the loop.
[[nodiscard]] bool cholesky_factor(std::uint32_t order, Float4* a) noexcept;

/// Solves in place with the factors of cholesky_factor. b: [n / 4], zero in the padding. For the loop.
void cholesky_solve(std::uint32_t order, const Float4* a, Float4* b) noexcept;

}  // namespace greenloop
