#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "sim_hw/guard/time_verdict.hpp"
#include "sim_hw/session/session.hpp"

namespace greenloop {

/// Thread CPU time of the loop's cycles, µs.
struct StepTime {
  double min = 0, median = 0, p99 = 0, max = 0;
};

/// What a run showed.
struct Verdict : RunTally {
  ContactBody::Energy energy;                         ///< J, at the end
  std::map<std::uint32_t, std::int64_t> levels_used;  ///< constraint level to cycles, all cycles
  StepTime step_us;
  TimeVerdict time;       ///< of the cycles
  bool complete = false;  ///< every cycle was run and both sides agree on the digest

  /// No miss, no allocation, nothing late beyond what was injected, and complete.
  bool held = false;

  /// The same, and time too where it is to be judged.
  [[nodiscard]] bool passed() const { return held && time.holds(); }
};

/// judge_time: whether times are judged, or only reported.
[[nodiscard]] Verdict judge(const SessionResult& result, bool judge_time);

/// The keys are part of the program's interface; see docs/device_loop.md.
[[nodiscard]] nlohmann::ordered_json to_json(const SessionOptions& options, const SessionResult& result,
                                             const Verdict& verdict);

/// One screen for people.
[[nodiscard]] std::string to_text(const SessionOptions& options, const SessionResult& result, const Verdict& verdict);

}  // namespace greenloop
