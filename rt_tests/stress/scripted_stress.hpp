#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "rt_tests/stress/guarded_steps.hpp"
#include "rt_tests/stress/predicted_work.hpp"
#include "rt_tests/stress/report_parts.hpp"
#include "sim_hw/guard/time_histogram.hpp"
#include "sim_hw/guard/time_verdict.hpp"

namespace greenloop {

// What stress runs of impulses and of multigrid bodies have in common: scripts of several kinds, each on a body of its
// own that a twin follows.

/// Steps of some cycles.
struct StepCounts {
  StepsByStatus by_status{};
  std::uint64_t worst_work = 0;     ///< units of the step that came nearest to what it may take
  std::uint64_t declared_work = 0;  ///< units, of that step: the most that it may take

  [[nodiscard]] std::uint64_t of(Status status) const { return by_status[static_cast<std::size_t>(status)]; }
  [[nodiscard]] std::uint64_t answers() const { return of(Status::ok) + of(Status::coarser); }
  [[nodiscard]] double declared_over_worst() const { return declared_over(declared_work, worst_work); }
  /// A step that took `work` of `most` units.
  void spend(std::uint64_t work, std::uint64_t most);
  void add(const StepCounts& other);
};

template <class Kind, class Limits>
struct ScriptedStressOptions {
  std::uint64_t cycles = 20000;
  std::uint64_t seed = 1;
  std::optional<Kind> script = std::nullopt;  ///< this one alone; else all, in turn
  Limits limits{};
  std::uint64_t budget = 0;  ///< units of every step; 0: the scripts'
  std::size_t histogram_bins = 400;
  InjectedFault fault = InjectedFault::none;
  std::function<void(Kind, std::uint64_t)> progress = nullptr;  ///< called every so often with cycles done
};

/// One script, on a body of its own: the same in any run of its kind, seed, limits and cycles.
template <class Kind, class Counts>
struct ScriptOutcome {
  Kind kind{};
  std::uint64_t cycles = 0;
  Counts counts;
  double worst_us = 0;
  std::uint64_t digest = 0;  ///< of every step's report and answer
};

template <class Kind, class Counts, class Requirement>
struct ScriptedStressResult {
  std::uint64_t cycles = 0;
  std::vector<ScriptOutcome<Kind, Counts>> scripts;
  Counts counts;  ///< of all scripts
  Violations violations;
  bool watches_system_calls = false;  ///< false: this kernel cannot tell
  std::optional<ScriptViolation<Kind>> first_violation;
  Requirement declared;
  std::uint64_t wrong_limits = 0;  ///< that were refused, as they should be
  std::uint64_t digest = 0;        ///< of the scripts' digests
  double create_ms = 0;            ///< of `create`, thread CPU time
  TimeHistogram times;             ///< of steps, thread CPU time

  [[nodiscard]] bool held() const { return violations.sum() == 0; }
};

/// A run, and what it was of.
template <class Options, class Result>
struct ScriptedStressReport {
  std::string model;  ///< path
  Options options;
  double rate = 0;  ///< Hz, of the steps
  Result result{};
  double open_ms = 0;  ///< of `Model::open`, thread CPU time
  TimeVerdict time{};
  std::optional<PredictedWork> predicted = std::nullopt;  ///< if instructions were counted
  double minutes_per_million = 0;                         ///< of cycles, by the wall clock

  /// "HELD", or "VIOLATED: work_overruns 3, locks 1".
  [[nodiscard]] std::string verdict() const { return verdict_of(result.violations); }
  [[nodiscard]] bool held() const { return result.held() && time.holds(); }
  /// The command that runs up to the first violation, if there is one.
  [[nodiscard]] std::string replay() const {
    if (!result.first_violation) return {};
    return fmt::format("greenloop-stress {} --seed {} --script {} --cycles {}", model, options.seed,
                       name(result.first_violation->script), result.first_violation->cycle + 1);
  }
  [[nodiscard]] nlohmann::json json() const;
  /// To standard output, for people: the verdict first.
  void print() const;
};

/// visit(kind, cycles) of the scripts that share the cycles; names: of all kinds.
template <class Kind, class Limits, class Names, class Visit>
void visit_kinds(const ScriptedStressOptions<Kind, Limits>& options, const Names& names, Visit visit) {
  const std::size_t kinds = options.script ? 1 : names.size();
  for (std::size_t k = 0; k < kinds; ++k) {
    const std::uint64_t share = options.cycles / kinds + (k < options.cycles % kinds ? 1 : 0);
    if (share > 0) visit(options.script.value_or(static_cast<Kind>(k)), share);
  }
}

/// What every script has in its JSON.
template <class Kind, class Counts>
[[nodiscard]] nlohmann::json script_json(const ScriptOutcome<Kind, Counts>& script) {
  return {{"name", name(script.kind)},
          {"cycles", script.cycles},
          {"answered", script.counts.answers()},
          {"coarser", script.counts.of(Status::coarser)},
          {"refused", script.cycles - script.counts.answers()},
          {"worst_work", script.counts.worst_work},
          {"worst_us", script.worst_us},
          {"digest", fmt::format("{:016x}", script.digest)}};
}

/// What every report has, without what its scripts are about.
template <class Options, class Result>
[[nodiscard]] nlohmann::json report_json(const ScriptedStressReport<Options, Result>& report) {
  const Result& result = report.result;
  nlohmann::json all = {{"model", report.model},
                        {"seed", report.options.seed},
                        {"rate", report.rate},
                        {"cycles", result.cycles},
                        {"virtual_seconds", static_cast<double>(result.cycles) / report.rate},
                        {"worst_work", result.counts.worst_work},
                        {"declared_work", result.counts.declared_work},
                        {"declared_over_worst", result.counts.declared_over_worst()},
                        {"least_work", result.declared.least_work},
                        {"predicted_over_instructions", nullptr},
                        {"instructions_max", nullptr},
                        {"wrong_limits", result.wrong_limits},
                        {"time", report.time},
                        {"time_verdict", report.time.word()},
                        {"digest", fmt::format("{:016x}", result.digest)},
                        {"open_ms", report.open_ms},
                        {"create_ms", result.create_ms},
                        {"arena_bytes", result.declared.bytes},
                        {"minutes_per_million_cycles", report.minutes_per_million},
                        {"histogram", as_json(result.times)},
                        {"scripts", nlohmann::json::array()},
                        {"statuses", statuses_json(result.counts.by_status)},
                        {"first_violation", nullptr},
                        {"verdict", result.held() ? "HELD" : "VIOLATED"}};
  add_violations(result.violations, result.watches_system_calls, all);
  if (report.predicted) {
    all["predicted_over_instructions"] = as_json(*report.predicted);
    all["instructions_max"] = report.predicted->heaviest_instructions;
  }
  if (result.first_violation) {
    all["first_violation"] = violation_json(*result.first_violation, report.options.seed, report.replay());
  }
  return all;
}

/// The verdict, what was violated first and the times, then a line about the run; subject: "motions".
template <class Options, class Result>
void print_opening(const ScriptedStressReport<Options, Result>& report, const char* subject) {
  const Result& result = report.result;
  fmt::print("{}\n", report.verdict());
  if (result.first_violation) print_violation(*result.first_violation, report.options.seed, report.replay());
  fmt::print("{}\n", report.time.text("step"));
  fmt::print(
      "{}: {} cycles of {}, {:.1f} s at {:.0f} Hz, seed {}; arena {} bytes, opened in {:.1f}, created in {:.2f} ms\n\n",
      report.model, result.cycles, subject, static_cast<double>(result.cycles) / report.rate, report.rate,
      report.options.seed, result.declared.bytes, report.open_ms, result.create_ms);
}

/// Statuses and work.
template <class Options, class Result>
void print_work(const ScriptedStressReport<Options, Result>& report) {
  const auto& counts = report.result.counts;
  fmt::print("\n");
  print_statuses(counts.by_status);
  fmt::print("nearest to what it may take: a step of {} of {} units, {:.2f} times as much\n", counts.worst_work,
             counts.declared_work, counts.declared_over_worst());
  if (report.predicted) {
    fmt::print("instructions of the heaviest kind of step {}\n", report.predicted->heaviest_instructions);
    print_ratios(report.predicted->ways, report.predicted->all);
  }
}

/// Limits that were refused, the digest and the histogram.
template <class Options, class Result>
void print_ending(const ScriptedStressReport<Options, Result>& report) {
  const Result& result = report.result;
  fmt::print("{} limits that are none were refused\n", result.wrong_limits);
  print_if_unwatched(result.watches_system_calls);
  fmt::print("digest {:016x}; {:.2f} minutes per million cycles\n\n", result.digest, report.minutes_per_million);
  print_histogram(result.times);
}

}  // namespace greenloop
