#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "sim_hw/guard/time_histogram.hpp"

namespace greenloop {

/// Processor times of steps against the period of a loop and the share of it that a step may take.
struct TimeVerdict {
  double period_us = 0;  ///< of the loop
  double share = 1;      ///< that a step may take, above 0 and at most 1
  double worst_us = 0, p50_us = 0, p99_us = 0, p999_us = 0;
  std::string unfit;      ///< why this machine cannot judge it; empty: it can
  bool is_asked = false;  ///< whether it is to be judged

  [[nodiscard]] bool within() const { return worst_us <= share * period_us; }

  /// Whether all that was asked for holds.
  [[nodiscard]] bool holds() const { return !is_asked || (unfit.empty() && within()); }

  /// "WITHIN" or "LATE" where it is asked for and the machine can judge it, else "NOT JUDGED".
  [[nodiscard]] std::string word() const;

  /// For people, in a line, and another where the machine cannot judge what it is asked to. timed: "step" or "cycle".
  [[nodiscard]] std::string text(const std::string& timed) const;
};

/// {period_us, share, worst_us, p50_us, p99_us, p999_us, within, can_judge}
void to_json(nlohmann::json& json, const TimeVerdict& time);

/// rate: Hz. A machine can judge times if this thread runs on one processor alone, and that is isolated from others.
[[nodiscard]] TimeVerdict judge_times(const TimeHistogram& times, double rate, double share, bool is_asked);

}  // namespace greenloop
