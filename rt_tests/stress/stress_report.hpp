#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "rt_tests/stress/stress_run.hpp"

namespace greenloop {

/// A run, and what it was of.
struct StressReport {
  std::string model;  ///< path
  StressOptions options;
  StressResult result;
  std::int64_t instructions_max = -1;  ///< -1: not counted
  double minutes_per_million = 0;      ///< of cycles, by the wall clock

  /// "HELD", or "VIOLATED: work_overruns 3, locks 1".
  [[nodiscard]] std::string verdict() const;

  /// The command that runs up to the first violation, if there is one.
  [[nodiscard]] std::string replay() const;

  [[nodiscard]] nlohmann::json json() const;

  /// To standard output, for people.
  void print() const;
};

}  // namespace greenloop
