#pragma once

#include <array>
#include <cstdint>

#include "runtime/elastostatic.hpp"

namespace greenloop {

/// A fault put into every hundredth step, to show that the verdict can fail.
enum class InjectedFault : std::uint8_t { none, allocation, lock, system_call, overrun };

struct StressOptions {
  std::uint64_t cycles = 20000;
  std::uint64_t seed = 1;
  Limits limits;
  InjectedFault fault = InjectedFault::none;
};

/// Execution times of steps, thread CPU time in bins of one microsecond.
struct TimeHistogram {
  static constexpr std::size_t bins = 100;

  std::array<std::uint64_t, bins> count{};
  std::uint64_t overflow = 0;  ///< at or above `bins` microseconds
  double least = 0, total = 0, most = 0;
};

struct StressResult {
  std::uint64_t cycles = 0;
  std::uint64_t answered = 0, coarser = 0, refused = 0, cached = 0;
  std::uint64_t levels[layout::max_levels] = {};  ///< answers by constraint level
  std::uint64_t work_overruns = 0;                ///< work above the budget or the declared bound
  std::uint64_t wrong_answers = 0;  ///< refused what is right, answered what is wrong, not finite, or held ones written
  std::uint64_t allocations = 0;
  std::uint64_t locks = 0;
  std::int64_t system_calls = 0;  ///< steps with any; -1: this kernel cannot tell
  std::uint64_t minor_faults = 0;
  std::uint64_t worst_work = 0;
  std::uint64_t declared_work = 0;
  double force_step_max = 0;  ///< N: largest change of the total force while one patch is pressed a little further
  std::uint64_t digest = 0;   ///< of every step's outcome
  TimeHistogram times;

  [[nodiscard]] bool passed() const {
    return work_overruns == 0 && wrong_answers == 0 && allocations == 0 && locks == 0 && system_calls <= 0 &&
           minor_faults == 0;
  }
};

/// Runs a ContactScript on a body of `model`, every step with the guards of sim_hw/guard armed, and checks each outcome
/// against what Elastostatic declares. Throws std::runtime_error if no body can be created.
[[nodiscard]] StressResult run_stress(const Model& model, const StressOptions& options);

}  // namespace greenloop
