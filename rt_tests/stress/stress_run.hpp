#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "rt_tests/harness/contact_script.hpp"
#include "rt_tests/harness/dear_sets.hpp"
#include "rt_tests/harness/driver.hpp"
#include "rt_tests/stress/guarded_steps.hpp"
#include "runtime/hosted/hosted.hpp"
#include "runtime/model.hpp"
#include "runtime/prices.hpp"
#include "sim_hw/guard/time_histogram.hpp"

namespace greenloop {

struct StressOptions {
  std::uint64_t cycles = 20000;
  std::uint64_t seed = 1;
  std::optional<ScriptKind> script = std::nullopt;  ///< this one alone; else all, in turn
  std::uint32_t contacts = 64;                      ///< most of a step
  std::uint32_t factors = 8;                        ///< sets of contacts that the body remembers
  std::size_t histogram_bins = 400;
  std::uint64_t budget = 0;  ///< of every step; 0: the scripts'
  Prices prices{};
  InjectedFault fault = InjectedFault::none;
  std::function<void(ScriptKind, std::uint64_t)> progress = nullptr;  ///< called every so often with the cycles done
};

/// One script, on a body of its own: the same in any run of its kind, seed, limits and cycles.
struct ScriptResult {
  ScriptKind kind = ScriptKind::mixed;
  std::uint64_t cycles = 0;
  AnswerCounts counts;
  double worst_us = 0;
  double force_step_max = 0;  ///< see StressResult
  std::uint64_t digest = 0;   ///< of every step's outcome
};

/// Where something was violated first.
struct FirstViolation {
  ScriptKind script = ScriptKind::mixed;
  std::uint64_t cycle = 0;  ///< of the script, from 0 on
};

struct StressResult {
  std::uint64_t cycles = 0;
  std::vector<ScriptResult> scripts;
  AnswerCounts counts;  ///< of all scripts
  Violations violations;
  bool watches_system_calls = false;  ///< false: this kernel cannot tell
  std::optional<FirstViolation> first_violation;
  std::uint64_t declared_work = 0;  ///< units, the most that any step may take
  /// Largest change of the contact forces from one answered cycle to the next, contacts and displacements the same, so
  /// that it comes of a change of level alone: ||f - f'|| over the larger of ||f|| and ||f'||.
  double force_step_max = 0;
  std::uint64_t digest = 0;  ///< of the scripts' digests
  double create_ms = 0;      ///< of `create`, thread CPU time
  std::size_t arena_bytes = 0;
  TimeHistogram times;  ///< of steps, thread CPU time

  [[nodiscard]] bool held() const { return violations.sum() == 0; }
};

/// Calls visit(kind, cycles) for the scripts that share the cycles.
template <class Visit>
void visit_scripts(const StressOptions& options, Visit visit) {
  const std::size_t kinds = options.script ? 1 : contact_script_names.size();
  for (std::size_t k = 0; k < kinds; ++k) {
    const std::uint64_t share = options.cycles / kinds + (k < options.cycles % kinds ? 1 : 0);
    if (share > 0) {
      visit(options.script.value_or(static_cast<ScriptKind>(k)), share);
    }
  }
}

/// The script of a kind for a body.
template <Driver D>
[[nodiscard]] ContactScript script_of(const Model& model, const Hosted<typename D::Solver>& host, ScriptKind kind,
                                      std::uint64_t seed) {
  std::vector<DearSet> dear;
  if (kind == ScriptKind::hunt) {
    dear = dear_sets<D>(model, host.limits(), seed);
  }
  return {model.view(), D::bounds(host.limits(), host.requirement()), kind, seed, std::move(dear)};
}

/// Runs a ContactScript of every kind on bodies of `model`, every step with the guards of sim_hw/guard armed, and
/// checks each outcome against what the solver declares. Throws std::runtime_error if no body can be created.
template <Driver D>
[[nodiscard]] StressResult run_stress(const Model& model, const StressOptions& options);

}  // namespace greenloop
