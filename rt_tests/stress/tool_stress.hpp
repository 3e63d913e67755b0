#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "rt_tests/harness/tool_script.hpp"
#include "rt_tests/harness/touching_checks.hpp"
#include "rt_tests/stress/guarded_steps.hpp"
#include "rt_tests/stress/report_parts.hpp"
#include "runtime/model.hpp"
#include "sim_hw/guard/time_histogram.hpp"
#include "sim_hw/guard/time_verdict.hpp"

namespace greenloop {

struct ToolStressOptions {
  std::uint64_t cycles = 20000;
  std::uint64_t seed = 1;
  std::optional<ToolScriptKind> script = std::nullopt;  ///< this one alone; else all, in turn
  std::uint32_t contacts = 64;                          ///< places that may touch, at most 256
  std::uint32_t factors = 4;
  std::uint32_t iterations = 50;
  std::uint64_t search_work = 0;  ///< ContactBody::Limits::search_work
  std::size_t histogram_bins = 400;
  InjectedFault fault = InjectedFault::none;
  std::function<void(ToolScriptKind, std::uint64_t)> progress = nullptr;  ///< called every so often with cycles done
};

/// Steps of some cycles.
struct ToolCounts : TouchCounts {
  std::array<std::uint64_t, statuses> by_status{};
  std::uint64_t faults = 0;                          ///< tools that were left out by name
  std::uint64_t left_out = 0;                        ///< places for which there was no room
  std::uint64_t unfinished = 0;                      ///< tools that the search's share did not suffice for
  std::uint64_t worst_work = 0, worst_touching = 0;  ///< units of a step; of these, of finding contacts

  [[nodiscard]] std::uint64_t of(Status status) const { return by_status[static_cast<std::size_t>(status)]; }
  [[nodiscard]] std::uint64_t answers() const { return of(Status::ok) + of(Status::coarser); }
};

/// One script, on a body of its own: the same in any run of its kind, seed, limits and cycles.
struct ToolScriptResult {
  ToolScriptKind kind = ToolScriptKind::wander;
  std::uint64_t cycles = 0;
  ToolCounts counts;
  double worst_us = 0;
  std::uint64_t digest = 0;  ///< of every step's outcome
};

struct ToolStressResult {
  std::uint64_t cycles = 0;
  std::vector<ToolScriptResult> scripts;
  ToolCounts counts;  ///< of all scripts
  Violations violations;
  bool watches_system_calls = false;  ///< false: this kernel cannot tell
  std::optional<ScriptViolation<ToolScriptKind>> first_violation;
  ContactBody::Requirement declared;
  std::uint64_t digest = 0;  ///< of the scripts' digests
  double create_ms = 0;      ///< of `create`, thread CPU time
  TimeHistogram times;       ///< of steps, thread CPU time

  [[nodiscard]] bool held() const { return violations.sum() == 0; }
};

/// Runs a ToolScript of every kind on bodies of `model`, every step with the guards of sim_hw/guard armed, and checks
/// each outcome: work within budget and declaration, forces that push and lie in their cones, finite numbers, refusals
/// where something is wrong and nowhere else, the last answer on a refusal. Throws std::runtime_error if no body can be
/// created.
[[nodiscard]] ToolStressResult run_tool_stress(const Model& model, const ToolStressOptions& options);

/// A run, and what it was of.
struct ToolStressReport {
  std::string model;  ///< path
  ToolStressOptions options;
  ToolStressResult result{};
  TimeVerdict time{};
  double minutes_per_million = 0;  ///< of cycles, by the wall clock

  /// "HELD", or "VIOLATED: work_overruns 3, locks 1".
  [[nodiscard]] std::string verdict() const { return verdict_of(result.violations); }
  [[nodiscard]] bool held() const { return result.held() && time.holds(); }
  [[nodiscard]] double declared_over_worst() const;
  /// The command that runs up to the first violation, if there is one.
  [[nodiscard]] std::string replay() const;
  [[nodiscard]] nlohmann::json json() const;
  /// To standard output, for people: the verdict first.
  void print() const;
};

}  // namespace greenloop
