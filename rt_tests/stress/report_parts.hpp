#pragma once

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "rt_tests/stress/guarded_steps.hpp"
#include "runtime/loop.hpp"
#include "sim_hw/guard/time_histogram.hpp"

namespace greenloop {

// What the reports of constraints, of tools and of impulses have in common.

/// 0 where no step took any work.
[[nodiscard]] double declared_over(std::uint64_t declared, std::uint64_t worst);

using StepsByStatus = std::array<std::uint64_t, statuses>;

/// {name of a status: steps}
[[nodiscard]] nlohmann::json statuses_json(const StepsByStatus& steps);

/// "steps by status:  ok 3  coarser 1", a line to standard output.
void print_statuses(const StepsByStatus& steps);

/// Adds each count by its name; null for system calls where they are not watched.
void add_violations(const Violations& violations, bool watches_system_calls, nlohmann::json& all);

/// To standard output, where it is so.
void print_if_unwatched(bool watches_system_calls);

/// Where something was violated first.
template <class Kind>
struct ScriptViolation {
  Kind script{};
  std::uint64_t cycle = 0;  ///< of the script, from 0 on
  std::string what;
};

/// {script, cycle, what, seed, replay}
template <class Kind>
[[nodiscard]] nlohmann::json violation_json(const ScriptViolation<Kind>& first, std::uint64_t seed,
                                            const std::string& replay) {
  return {
      {"script", name(first.script)}, {"cycle", first.cycle}, {"what", first.what}, {"seed", seed}, {"replay", replay}};
}

/// The same in two lines to standard output.
template <class Kind>
void print_violation(const ScriptViolation<Kind>& first, std::uint64_t seed, const std::string& replay) {
  fmt::print("first in script {}, seed {}, cycle {}: {}; again with\n  {}\n", name(first.script), seed, first.cycle,
             first.what, replay);
}

/// {unit, clock, count[], overflows, total, min, avg, max}
[[nodiscard]] nlohmann::json as_json(const TimeHistogram& times);

/// To standard output, as cyclictest prints it; empty bins are left out.
void print_histogram(const TimeHistogram& times);

}  // namespace greenloop
