#pragma once

#include <span>

#include "runtime/multigrid/level.hpp"

namespace greenloop {

/// x from L L^T x = b. scratch: [3 vertices]. For the loop; work: the numbers of L, twice.
void solve_coarsest(const CoarsestFactor& factor, std::span<const Float4> b, std::span<double> scratch,
                    std::span<Float4> x) noexcept;

}  // namespace greenloop
