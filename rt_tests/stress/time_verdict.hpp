#pragma once

#include <string>

#include "rt_tests/harness/time_histogram.hpp"

namespace greenloop {

/// Processor times of steps against the period of a loop and the share of it that a step may take.
struct TimeVerdict {
  double period_us = 0;  ///< of the loop
  double share = 1;      ///< that a step may take, 0..1
  double worst_us = 0, p50_us = 0, p99_us = 0, p999_us = 0;
  std::string unfit;  ///< why this machine cannot judge it; empty: it can

  [[nodiscard]] bool within() const { return worst_us <= share * period_us; }
};

/// rate: Hz. A machine can judge times if this thread runs on one processor alone, and that is isolated from others.
[[nodiscard]] TimeVerdict judge_times(const TimeHistogram& times, double rate, double share);

}  // namespace greenloop
