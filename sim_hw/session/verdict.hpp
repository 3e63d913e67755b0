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
struct Verdict {
  std::int64_t cycles = 0;
  std::int64_t misses = 0;       ///< cycles that spent more than their budget or had to hold the last response
  std::int64_t first_miss = -1;  ///< its cycle, -1: none
  std::uint64_t worst_work = 0;  ///< units
  std::int64_t contact_cycles = 0;
  std::uint32_t contacts_max = 0;
  double force_max = 0;                               ///< N
  CycleRecord strongest;                              ///< the cycle in which it was
  double force_step_max = 0;                          ///< N, of a probe's force from a cycle to the next
  double residual_max = 0;                            ///< of the contact laws
  std::int64_t fall_throughs = 0;                     ///< probes and cycles behind the surface without a force
  std::uint64_t worst_touching = 0;                   ///< units, of finding what touches
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
