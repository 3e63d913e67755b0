#pragma once

#include <span>

#include "runtime/multigrid/level.hpp"

namespace greenloop {

/// coarse = P^T (b - A x) where x is what sweep_from_zero left: then the residual is that of the blocks right of the
/// diagonal alone. For the loop; work: these blocks and the parents.
void restrict_residual(const MultigridLevel& fine, std::span<const Float4> x, std::span<Float4> coarse) noexcept;

/// x += P coarse. For the loop; work: the parents.
void add_prolonged(const MultigridLevel& fine, std::span<const Float4> coarse, std::span<Float4> x) noexcept;

}  // namespace greenloop
