#pragma once

#include "runtime/multigrid/elastic_body.hpp"

namespace greenloop {

/// Forces out of balance in the state `next`: residual = loads + inertia and inner forces; held vertices' entries are
/// what holds them. Finds frames first. For the loop; work: residual_work.
struct Imbalance {
  double moving = 0;  ///< of vertices that move, sum of squares, N^2
  double held = 0;    ///< of those that are held: their reactions
};
Imbalance find_residual(ElasticBody& body) noexcept;

struct Solved {
  std::uint32_t cycles = 0;
  std::uint64_t work = 0;
};

/// Moves `next` by about the solution of (operator) change = residual: conjugate gradients (Golub & Van Loan
/// section 11.5, the direction by Polak and Ribiere), until its residual is below `goal` (squared, N^2) or the next
/// iteration does not fit into `work`. For the loop; work: pass_work and iteration_work each.
/// The first pass of a step goes along the last acceleration first, for product_work more.
Solved newton_pass(ElasticBody& body, bool first, double goal, std::uint64_t work) noexcept;

}  // namespace greenloop
