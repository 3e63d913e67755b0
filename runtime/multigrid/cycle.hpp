#pragma once

#include <span>

#include "runtime/multigrid/level.hpp"

namespace greenloop {

/// A hierarchy, finest level first, and what its cycles write to.
struct MultigridCycle {
  /// Right side and answer of a level: [vertices] each, fourth lanes 0.
  struct Fields {
    std::span<Float4> b, x;
  };

  std::span<const MultigridLevel> levels;  ///< all but the coarsest
  CoarsestFactor coarsest;
  std::span<const Fields> fields;  ///< of the levels and of the coarsest
  std::span<double> scratch;       ///< [3 coarsest.vertices]
};

/// fields[0].x = about A^-1 fields[0].b by one V(1,1) cycle from 0 (Georgii & Westermann 2005, section 3.2.2): down
/// with a sweep forwards on each level, up with one backwards, so that it is symmetric and positive definite. For the
/// loop; work: every block twice, every parent twice, the coarsest factor twice.
void v_cycle(const MultigridCycle& cycle) noexcept;

}  // namespace greenloop
