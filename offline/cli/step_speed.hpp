#pragma once

#include <cstddef>
#include <optional>

#include "runtime/elastostatic.hpp"

namespace greenloop::offline {

/// What a body of a model costs on the machine that asks, by the processor time of this thread.
struct StepSpeed {
  double create_ms = 0;        ///< of Elastostatic::create, in memory that has been touched
  double us_per_unit = 0;      ///< median over the steps
  double us_per_unit_p95 = 0;  ///< 95th percentile
  std::size_t steps = 0;       ///< that were answered and timed; 0: nothing is known of units
};

/// Makes a body and runs steps with fields for about `seconds` of processor time, at least two: patches of as many
/// neighbouring nodes as the limits allow, pressed, kept and moved on by a node, and as many nodes all over the body.
/// The first step, in cold caches, does not count. None if there is no such body. Uses the clock and the heap.
[[nodiscard]] std::optional<StepSpeed> measure_speed(const Model& model, const Elastostatic::Limits& limits,
                                                     Budget budget, double seconds);

}  // namespace greenloop::offline
