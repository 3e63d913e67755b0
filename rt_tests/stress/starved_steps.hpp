#pragma once

#include <cstdint>

#include "rt_tests/harness/driver.hpp"
#include "rt_tests/stress/stress_run.hpp"
#include "runtime/model.hpp"

namespace greenloop {

/// How the total force on a moving tool steps from cycle to cycle on a starved body, over how it steps where every
/// cycle is answered at the finest level.
struct StarvedSteps {
  double finest = 0;  ///< N, largest step of the total force with any budget
  double tenth =
      0;  ///< largest step at a tenth, or another share, of the work of the dearest of those cycles, over `finest`
  double quarter = 0;  ///< the same at a quarter
  double apart = 0;    ///< the same with any budget, where the new contact is held a cycle after the old one has gone
};

/// A patch of up to 16 nodes, pressed by 1 mm over its first 32 cycles, that moves on by a node every 16 cycles: a new
/// constraint comes, an old one goes, all others stay. `cycles` cycles on bodies of their own with the contacts,
/// factors and prices of `options`, whose seed says where the tool starts, at budgets that are not below the least
/// admissible. Throws std::runtime_error if no body can be created.
template <Driver D>
[[nodiscard]] StarvedSteps starved_steps(const Model& model, const StressOptions& options, std::uint64_t cycles,
                                         double share = 0.1);

}  // namespace greenloop
