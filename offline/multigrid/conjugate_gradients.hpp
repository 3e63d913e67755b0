#pragma once

#include <functional>

#include "offline/multigrid/block_matrix.hpp"

namespace greenloop::offline {

struct Convergence {
  double residual;  ///< |b - A x| / |b|, computed anew from x in double precision
  int iterations;
  bool reached;  ///< whether that is within what was asked
};

/// Applies a symmetric positive definite preconditioner: z from r.
using Preconditioner = std::function<void(std::span<const Double4> r, std::span<Double4> z)>;

/// Conjugate gradients from x (Golub & Van Loan section 11.5), the direction by Polak and Ribiere, which bears a
/// preconditioner in single precision (Notay 2000). Success is decided by the true residual: iterations begin again
/// from it while it is above `tolerance` and still falls.
Convergence conjugate_gradients(const BlockMatrix& matrix, const Preconditioner& precondition,
                                std::span<const Double4> b, std::span<Double4> x, double tolerance,
                                int most_iterations);

}  // namespace greenloop::offline
