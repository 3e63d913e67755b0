#pragma once

#include <cstdint>

#include "runtime/algebra/block.hpp"
#include "runtime/wavelet/reach.hpp"
#include "runtime/wavelet/refinement.hpp"

namespace greenloop {

// The transform of sparse nodal forces into wavelet coefficients, T_l^-T for l = c..1 (docs/theory.md):
//   g_a = f_a + (sum of w^T f_m over the odd m that a predicts with weight w),
//   e_m = f_m - (sum of lift(m -> a) g_a over parents a),
// in place, by place in the domain, since the places of K(l-1) come before those of M(l). With a unit force at one node
// it gives the weights with which that node's displacement depends on every coefficient.

/// Forces on columns.
struct ColumnForces {
  std::uint32_t count;
  const std::uint32_t* column;  ///< [count] of distinct places, coarser ones first
  const float* force;           ///< [N * count] newtons if N is 3; denormal numbers count as 0
};

/// The force coefficients T^-T f of forces on columns, each of which enters on its own level. touched: by the same
/// columns; force: [domain], 0 before. For the loop; work: force_visit_price per visit.
template <unsigned N>
void transform_forces(const Refinement& refinement, const ColumnForces& columns, const Touched& touched,
                      Vector<N>* force) noexcept;

/// Zeroes the touched coefficients. For the loop; work: one unit per coefficient.
template <unsigned N>
void clear_forces(const Touched& touched, Vector<N>* force) noexcept;

}  // namespace greenloop
