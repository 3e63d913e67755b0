#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "rt_tests/stress/predicted_work.hpp"
#include "rt_tests/stress/starved_steps.hpp"
#include "rt_tests/stress/stress_run.hpp"
#include "sim_hw/guard/time_verdict.hpp"

namespace greenloop {

/// A run, and what it was of.
struct StressReport {
  std::string model;  ///< path
  StressOptions options;
  StressResult result{};
  double open_ms = 0;  ///< of `Model::open`, thread CPU time
  TimeVerdict time{};
  StarvedSteps starved{};
  std::optional<PredictedWork> predicted = std::nullopt;  ///< if instructions were counted
  double minutes_per_million = 0;                         ///< of cycles, by the wall clock

  /// What the body declares: "HELD", or "VIOLATED: work_overruns 3, locks 1".
  [[nodiscard]] std::string verdict() const;

  /// Whether all that was asked for holds.
  [[nodiscard]] bool held() const { return result.held() && time.holds(); }

  [[nodiscard]] double declared_over_worst() const {
    return static_cast<double>(result.declared_work) / static_cast<double>(result.counts.worst_work);
  }

  /// The command that runs up to the first violation, if there is one.
  [[nodiscard]] std::string replay() const;

  [[nodiscard]] nlohmann::json json() const;

  /// To standard output, for people: the verdict first.
  void print() const;

 private:
  void print_verdict() const;
};

}  // namespace greenloop
