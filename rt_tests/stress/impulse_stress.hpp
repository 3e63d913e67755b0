#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "rt_tests/stress/guarded_steps.hpp"
#include "rt_tests/stress/impulse_stress_script.hpp"
#include "rt_tests/stress/predicted_work.hpp"
#include "rt_tests/stress/report_parts.hpp"
#include "runtime/impulse_response.hpp"
#include "sim_hw/guard/time_histogram.hpp"
#include "sim_hw/guard/time_verdict.hpp"

namespace greenloop {

struct ImpulseStressOptions {
  std::uint64_t cycles = 20000;
  std::uint64_t seed = 1;
  std::optional<ImpulseScriptKind> script = std::nullopt;  ///< this one alone; else all, in turn
  ImpulseResponse::Limits limits{};                        ///< of all scripts but `paces`
  std::uint64_t budget = 0;                                ///< units of every step; 0: the scripts'
  std::size_t histogram_bins = 400;
  InjectedFault fault = InjectedFault::none;
  std::function<void(ImpulseScriptKind, std::uint64_t)> progress = nullptr;  ///< called every so often with cycles done
};

/// Steps of some cycles.
struct ImpulseCounts {
  std::array<std::uint64_t, statuses> by_status{};
  std::uint64_t entered = 0;        ///< impulses that were followed
  std::uint64_t blending = 0;       ///< of these, while an earlier difference was left
  std::uint64_t continued = 0;      ///< steps in which an orbit went on in another
  std::uint64_t worst_work = 0;     ///< units of the step that came nearest to what its body declares
  std::uint64_t declared_work = 0;  ///< units, of that body: the most that any step may take
  double most_blend = 0;            ///< m, largest difference that blending had to take out
  double most_energy = 0;           ///< m^2, largest |q_u|^2 + rho^2 |q_v|^2 of the bodies of the model's limits
  double most_energy_share = 0;     ///< the largest, of any body, over its bound

  [[nodiscard]] std::uint64_t of(Status status) const { return by_status[static_cast<std::size_t>(status)]; }
  [[nodiscard]] std::uint64_t answers() const { return of(Status::ok) + of(Status::coarser); }
  [[nodiscard]] double declared_over_worst() const { return declared_over(declared_work, worst_work); }
  void add(const ImpulseCounts& other);
};

/// One script, on a body of its own: the same in any run of its kind, seed, limits and cycles.
struct ImpulseScriptResult {
  ImpulseScriptKind kind = ImpulseScriptKind::mixed;
  std::uint64_t cycles = 0;
  ImpulseCounts counts;
  double worst_us = 0;
  std::uint64_t digest = 0;  ///< of every step's report and answer
};

/// Where something was violated first.
struct FirstImpulseViolation {
  ImpulseScriptKind script = ImpulseScriptKind::mixed;
  std::uint64_t cycle = 0;  ///< of the script, from 0 on
  std::string what;
};

struct ImpulseStressResult {
  std::uint64_t cycles = 0;
  std::vector<ImpulseScriptResult> scripts;
  ImpulseCounts counts;  ///< of all scripts
  Violations violations;
  bool watches_system_calls = false;  ///< false: this kernel cannot tell
  std::optional<FirstImpulseViolation> first_violation;
  ImpulseResponse::Requirement declared;
  double energy_bound = 0;         ///< m^2, of the bodies of the model's limits
  std::uint64_t wrong_limits = 0;  ///< that were refused, as they should be
  std::uint64_t digest = 0;        ///< of the scripts' digests
  double create_ms = 0;            ///< of `create`, thread CPU time
  TimeHistogram times;             ///< of steps, thread CPU time

  [[nodiscard]] bool held() const { return violations.sum() == 0; }
};

/// Runs an ImpulseStressScript of every kind on bodies of `model`, every step with the guards of sim_hw/guard armed,
/// and checks each: what_is_wrong says of it, the energy of the state against what `motion_bounds` says, buffers that a
/// refused step leaves, and a twin that never was given what was refused: it is in the same state to the bit. Limits
/// that are none, NaN, infinite, zero, huge, must be refused before. Throws std::runtime_error if no body can be
/// created.
[[nodiscard]] ImpulseStressResult run_impulse_stress(const Model& model, const ImpulseStressOptions& options);

/// The same steps without guards, and at last the heaviest kind: an impulse, all vertices and their velocities.
[[nodiscard]] std::vector<ReportedStep> run_impulses_plainly(const Model& model, const ImpulseStressOptions& options);

/// A run, and what it was of.
struct ImpulseStressReport {
  std::string model;  ///< path
  ImpulseStressOptions options;
  double rate = 0;  ///< Hz, of the loop
  ImpulseStressResult result{};
  double open_ms = 0;  ///< of `Model::open`, thread CPU time
  TimeVerdict time{};
  std::optional<PredictedWork> predicted = std::nullopt;  ///< if instructions were counted
  double minutes_per_million = 0;                         ///< of cycles, by the wall clock

  /// "HELD", or "VIOLATED: work_overruns 3, locks 1".
  [[nodiscard]] std::string verdict() const { return verdict_of(result.violations); }
  [[nodiscard]] bool held() const { return result.held() && time.holds(); }
  /// The command that runs up to the first violation, if there is one.
  [[nodiscard]] std::string replay() const;
  [[nodiscard]] nlohmann::json json() const;
  /// To standard output, for people: the verdict first.
  void print() const;
};

}  // namespace greenloop
