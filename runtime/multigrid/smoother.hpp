#pragma once

#include <span>

#include "runtime/multigrid/level.hpp"

namespace greenloop {

// Block Gauss-Seidel in the order of the vertices, and backwards, so that both together are symmetric. For the loop.

/// (D + L) x = b: a sweep forwards from 0. Work: the blocks left of the diagonal, and those on it.
void sweep_from_zero(const MultigridLevel& level, std::span<const Float4> b, std::span<Float4> x) noexcept;

/// From `x`. Work: all blocks.
void sweep_backwards(const MultigridLevel& level, std::span<const Float4> b, std::span<Float4> x) noexcept;

}  // namespace greenloop
