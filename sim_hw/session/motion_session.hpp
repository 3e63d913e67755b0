#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "sim_hw/guard/time_verdict.hpp"
#include "sim_hw/motion/motion_log.hpp"
#include "sim_hw/session/session.hpp"

namespace greenloop {

/// A run of motions that came to its end, well or badly.
struct MotionResult : LinkResult {
  std::int64_t field_every = 1;  ///< cycles, of displacements of all vertices
  std::uint32_t modes = 0;       ///< of the model
  MotionBounds bounds;
  LinkSummary device;
  MotionLog log{0, 0, 0, false};
};

/// Runs a device that gives impulses and a loop that plays a model of motions against each other in lock step; takes
/// model, seconds, rate, share, budget, starve, transport, field_every (by default 60 frames a second), faults,
/// overrun_cycle and keep_records of the options. Throws std::runtime_error if the run cannot start (model, rate, a
/// budget that does not hold the coarsest frame, no namespace for udpm) or one side vanishes.
/// With udpm the calling thread changes to a network namespace of its own; no other thread may run then.
[[nodiscard]] MotionResult run_motion_session(const SessionOptions& options);

/// What a run showed.
struct MotionVerdict : MotionTally {
  TimeVerdict time;       ///< of the cycles
  bool complete = false;  ///< every cycle was run and both sides agree on the digest
  bool smooth = false;    ///< jumps and energy within what is said of any impulses (motion_bounds)
  /// No miss, no allocation, nothing late beyond what was injected, refusals that held the last state, smooth,
  /// complete.
  bool held = false;

  /// The same, and time too where it is to be judged.
  [[nodiscard]] bool passed() const { return held && time.holds(); }
};

/// judge_time: whether times are judged, or only reported.
[[nodiscard]] MotionVerdict judge(const MotionResult& result, bool judge_time);

/// The keys are part of the program's interface; see docs/device_loop.md.
[[nodiscard]] nlohmann::ordered_json to_json(const SessionOptions& options, const MotionResult& result,
                                             const MotionVerdict& verdict);

/// One screen for people.
[[nodiscard]] std::string to_text(const SessionOptions& options, const MotionResult& result,
                                  const MotionVerdict& verdict);

}  // namespace greenloop
