#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "rt_tests/stress/elastic_stress_script.hpp"
#include "rt_tests/stress/guarded_steps.hpp"
#include "rt_tests/stress/predicted_work.hpp"
#include "rt_tests/stress/report_parts.hpp"
#include "sim_hw/guard/time_histogram.hpp"
#include "sim_hw/guard/time_verdict.hpp"

namespace greenloop {

struct ElasticStressOptions {
  std::uint64_t cycles = 20000;
  std::uint64_t seed = 1;
  std::optional<ElasticScriptKind> script = std::nullopt;  ///< this one alone; else all, in turn
  Multigrid::Limits limits{};
  std::uint64_t budget = 0;  ///< units of every step; 0: the scripts'
  std::size_t histogram_bins = 400;
  InjectedFault fault = InjectedFault::none;
  std::function<void(ElasticScriptKind, std::uint64_t)> progress = nullptr;  ///< called every so often with cycles done
};

/// Steps of some cycles.
struct ElasticCounts {
  std::array<std::uint64_t, statuses> by_status{};
  std::uint64_t multigrid_cycles = 0;
  std::uint64_t worst_work = 0;           ///< units of the step that came nearest to its budget
  std::uint64_t declared_work = 0;        ///< units, of that budget
  double residual_sum = 0, residual = 0;  ///< relative: of all answers, and the largest
  double farthest = 0;                    ///< m, largest displacement

  [[nodiscard]] std::uint64_t of(Status status) const { return by_status[static_cast<std::size_t>(status)]; }
  [[nodiscard]] std::uint64_t answers() const { return of(Status::ok) + of(Status::coarser); }
  [[nodiscard]] double mean_residual() const;
  [[nodiscard]] double declared_over_worst() const { return declared_over(declared_work, worst_work); }
  void add(const ElasticCounts& other);
};

/// One script, on a body of its own: the same in any run of its kind, seed, limits and cycles.
struct ElasticScriptResult {
  ElasticScriptKind kind = ElasticScriptKind::mixed;
  std::uint64_t cycles = 0;
  ElasticCounts counts;
  double worst_us = 0;
  std::uint64_t digest = 0;  ///< of every step's report and answer
};

/// Where something was violated first.
struct FirstElasticViolation {
  ElasticScriptKind script = ElasticScriptKind::mixed;
  std::uint64_t cycle = 0;  ///< of the script, from 0 on
  std::string what;
};

struct ElasticStressResult {
  std::uint64_t cycles = 0;
  std::vector<ElasticScriptResult> scripts;
  ElasticCounts counts;  ///< of all scripts
  Violations violations;
  bool watches_system_calls = false;  ///< false: this kernel cannot tell
  std::optional<FirstElasticViolation> first_violation;
  Multigrid::Requirement declared;
  std::uint64_t wrong_limits = 0;  ///< that were refused, as they should be
  std::uint64_t digest = 0;        ///< of the scripts' digests
  double create_ms = 0;            ///< of `create`, thread CPU time
  TimeHistogram times;             ///< of steps, thread CPU time

  [[nodiscard]] bool held() const { return violations.sum() == 0; }
};

/// Runs an ElasticStressScript of every kind on bodies of `model`, every step with the guards of sim_hw/guard armed,
/// and checks each: no work beyond its budget, refused by its name what is wrong and nothing else, answers finite,
/// buffers that a refused step leaves, no state that is not finite but by what is huge, and a twin that never was given
/// what was refused: it is where the body is to the bit. Limits that are none must be refused before. Throws
/// std::runtime_error if no body can be created.
[[nodiscard]] ElasticStressResult run_elastic_stress(const Model& model, const ElasticStressOptions& options);

/// The same steps without guards, and at last the heaviest kind: all loads and holds, all answers, eight cycles.
[[nodiscard]] std::vector<ReportedStep> run_elastic_plainly(const Model& model, const ElasticStressOptions& options);

/// A run, and what it was of.
struct ElasticStressReport {
  std::string model;  ///< path
  ElasticStressOptions options;
  double rate = 0;  ///< Hz, of the model's time step
  ElasticStressResult result{};
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
