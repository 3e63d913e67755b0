#pragma once

#include <cstdint>

#include "runtime/prices.hpp"

namespace greenloop {

// Square-root-free Cholesky factors of a matrix that may be singular: a row that depends on those before it is left out
// of the system. A matrix stands by columns, `stride` floats apart; only its lower triangle is read and written.
// Factors hold L below the diagonal and the inverse of D on it, 0 where a row is left out. In a fixed order of
// operations; for the loop.

/// Work units of factor_semidefinite and solve_semidefinite together: multiply-adds, and what it takes to begin a
/// column of them, a dozen.
constexpr std::uint64_t semidefinite_work(const Prices& prices, std::uint64_t order) {
  return priced(order * (order + 4) * (order + 8) / 6 + 12 * order * order, prices.appended) +
         priced(order * order + order, prices.substituted);
}

/// Factors A = L D L^T in place. share: of its diagonal entry, that a pivot has to be above. diagonal: [order] scratch.
/// Returns how many rows were left out.
std::uint32_t factor_semidefinite(std::uint32_t order, std::uint32_t stride, float share, float* a,
                                  float* diagonal) noexcept;

/// Solves in place; what was left out is 0. b: [order].
void solve_semidefinite(std::uint32_t order, std::uint32_t stride, const float* a, float* b) noexcept;

}  // namespace greenloop
