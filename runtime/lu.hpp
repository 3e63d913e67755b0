#pragma once

#include <cstdint>

#include "runtime/float4.hpp"

namespace greenloop {

/// Order of the padded matrix: whole vectors.
constexpr std::uint32_t lu_padded(std::uint32_t order) { return (order + 3) / 4 * 4; }

/// Work units of lu_factor: multiply-adds of the elimination, and two passes for pivots, exchanges and scaling.
constexpr std::uint64_t lu_factor_work(std::uint32_t order) {
  const std::uint64_t n = lu_padded(order);
  return n * (n + 1) * (2 * n + 1) / 6 + 2 * n * n;
}

/// Work units of lu_solve.
constexpr std::uint64_t lu_solve_work(std::uint32_t order) {
  const std::uint64_t n = lu_padded(order);
  return n * n + n;
}

/// LU factors with partial pivoting, in place, in a fixed order of operations (Golub & Van Loan, Matrix Computations,
/// section 3.4, in panels of four columns).
/// a: [n * n / 4] by columns, n = lu_padded(order), 16-byte aligned; what stands in the padding is ignored. On success
/// it holds L below the diagonal, U above it and the inverse pivots on it. exchange: [n], the row exchanged with row k.
/// False if a pivot is below order * epsilon * the largest entry, or not a number. For the loop.
[[nodiscard]] bool lu_factor(std::uint32_t order, Float4* a, std::uint32_t* exchange) noexcept;

/// Solves in place with the factors of lu_factor. b: [n / 4], zero in the padding. For the loop.
void lu_solve(std::uint32_t order, const Float4* a, const std::uint32_t* exchange, Float4* b) noexcept;

}  // namespace greenloop
