#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "rt_tests/firmware/image/image_driver.hpp"

namespace greenloop::firmware {

/// A hand of eight contacts on a body in a 1 kHz interrupt: they are displaced further in every cycle, and a node
/// leaves the patch for another as often as `Motion` says. The field of all nodes is asked for in every cycle.
struct Motion {
  const char* name;
  std::uint32_t cycles_per_node;  ///< 0: the patch stays
  bool factor_at_hand;            ///< the first patch's factor is computed before the loop begins
};

struct Timing {
  std::uint32_t cycles = 0;
  std::uint32_t median = 0, worst = 0;  ///< instructions of a step
  std::uint32_t finest = 0;             ///< steps answered at the finest level
  std::uint32_t refined = 0;            ///< steps before the first of those; `cycles` if there is none
  std::uint32_t waiting = 0;            ///< steps in which new contacts wait
  std::uint32_t held = 0;               ///< steps that were not answered
  std::uint32_t late = 0;               ///< cycles that took longer than the period
  std::uint64_t worst_work = 0;         ///< units
};

inline constexpr std::uint32_t contacts_per_step = 8;
inline constexpr std::uint32_t timed_cycles = 1000;

/// Runs `timed_cycles` steps in the periodic interrupt. nodes: touchable nodes, neighbours beside each other. With
/// `slow` a step is repeated until the bar is missed, a negative control.
[[nodiscard]] Timing run_timed_loop(Solver& body, Budget budget, std::span<const std::uint32_t> nodes,
                                    std::span<float> field, const Motion& motion, bool slow);

}  // namespace greenloop::firmware
