#pragma once

#include <cstdint>

#include "runtime/algebra/float4.hpp"
#include "runtime/prices.hpp"

namespace greenloop {

/// Order of the padded matrix: whole vectors.
constexpr std::uint32_t padded_order(std::uint32_t order) { return (order + 3) / 4 * 4; }

/// Work units of cholesky_factor: multiply-adds of the elimination, and two passes for padding and scaling.
constexpr std::uint64_t cholesky_factor_work(const Prices& prices, std::uint32_t order) {
  const std::uint64_t n = padded_order(order);
  return priced(n * (n + 4) * (n + 8) / 6, prices.eliminated) + priced(2 * n * n, prices.passed);
}

/// Work units of cholesky_solve.
constexpr std::uint64_t cholesky_solve_work(const Prices& prices, std::uint32_t order) {
  const std::uint64_t n = padded_order(order);
  return priced(n * n + n, prices.substituted);
}

/// Work units of cholesky_append of `added` rows to `order`.
constexpr std::uint64_t cholesky_append_work(const Prices& prices, std::uint32_t order, std::uint32_t added) {
  const std::uint64_t n = padded_order(order + added);
  return priced(added * (n * n / 2 + 6 * n) + 4 * n, prices.appended);
}

/// Work units of cholesky_remove of `removed` rows from `order`, the first of them at `first`.
constexpr std::uint64_t cholesky_remove_work(const Prices& prices, std::uint32_t order, std::uint32_t first,
                                             std::uint32_t removed) {
  const std::uint64_t m = order - first;
  return priced(removed * (m * m + 8 * m), prices.removed) +
         priced(std::uint64_t{order} * order / 2 + 4 * std::uint64_t{order}, prices.passed);
}

// Square-root-free Cholesky factors, A = L D L^T, in place, in a fixed order of operations. A matrix stands by columns,
// `stride` floats apart, a multiple of 4 and at least the padded order, 16-byte aligned; only its lower triangle is
// read and written. Factors hold L below the diagonal and the inverse of D on it, extended to whole vectors by the
// identity. All for the loop.

/// Factors a matrix (Golub & Van Loan, Matrix Computations, section 4.1, in panels of four columns). What stands in the
/// padding is ignored. False if a pivot is not finite, or not above the rounding error of the diagonal entry that it is
/// left of: then the matrix is not positive definite to working precision.
[[nodiscard]] bool cholesky_factor(std::uint32_t order, std::uint32_t stride, Float4* a) noexcept;

using CholeskyFactor = bool (*)(std::uint32_t order, std::uint32_t stride, Float4* a) noexcept;

/// cholesky_factor in its fastest form on this processor, of the same bits. Start-up.
[[nodiscard]] CholeskyFactor fastest_cholesky_factor() noexcept;

/// Solves in place. b: [padded order / 4], zero in the padding.
void cholesky_solve(std::uint32_t order, std::uint32_t stride, const Float4* a, Float4* b) noexcept;

/// Factors of the matrix with `added` more rows and columns, by bordering (Golub & Van Loan, section 6.5.4). border:
/// row r, `stride` floats apart, holds entries 0 .. order + r of the new row r, and is overwritten. False as in
/// cholesky_factor; then the factors are spoilt.
[[nodiscard]] bool cholesky_append(std::uint32_t order, std::uint32_t added, std::uint32_t stride, Float4* a,
                                   Float4* border) noexcept;

/// Factors of the matrix without the rows and columns first .. first + removed - 1, by rank-one updates of what follows
/// (Gill, Golub, Murray & Saunders 1974, method C1): these only add, so they are stable. scratch: [removed * stride /
/// 4].
void cholesky_remove(std::uint32_t order, std::uint32_t first, std::uint32_t removed, std::uint32_t stride, Float4* a,
                     Float4* scratch) noexcept;

}  // namespace greenloop
