#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "sim_hw/drag/drag_log.hpp"
#include "sim_hw/guard/time_verdict.hpp"
#include "sim_hw/session/session.hpp"

namespace greenloop {

/// A run of a dragged body that came to its end, well or badly.
struct DragResult : LinkResult {
  std::int64_t field_every = 1;  ///< cycles, of displacements of the shown surface
  std::uint32_t tetrahedra = 0;
  double size = 0;  ///< m, diagonal of the box of the body at rest
  LinkSummary device;
  DragLog log;
};

/// Runs a tool that drags a multigrid model and the loop that steps it against each other in lock step; the rate is
/// that of the model's time step. Takes model, seconds, share, budget, starve, transport, field_every (by default 60
/// frames a second), faults, overrun_cycle and keep_records of the options. Throws std::runtime_error if the run cannot
/// start (model, a budget that does not hold a step of one cycle with the shown surface, no namespace for udpm) or one
/// side vanishes. With udpm the calling thread changes to a network namespace of its own; no other thread may run then.
[[nodiscard]] DragResult run_drag_session(const SessionOptions& options);

/// What a run showed.
struct DragVerdict : DragTally {
  TimeVerdict time;       ///< of the cycles
  bool complete = false;  ///< every cycle was run and both sides agree on the digest
  bool bounded = false;   ///< every cycle was answered, and nothing got farther than the body's size
  /// No miss, no allocation, nothing late beyond what was injected, bounded, complete.
  bool held = false;

  /// The same, and time too where it is to be judged.
  [[nodiscard]] bool passed() const { return held && time.holds(); }
};

/// judge_time: whether times are judged, or only reported.
[[nodiscard]] DragVerdict judge(const DragResult& result, bool judge_time);

/// The keys are part of the program's interface; see docs/device_loop.md.
[[nodiscard]] nlohmann::ordered_json to_json(const SessionOptions& options, const DragResult& result,
                                             const DragVerdict& verdict);

/// One screen for people.
[[nodiscard]] std::string to_text(const SessionOptions& options, const DragResult& result, const DragVerdict& verdict);

}  // namespace greenloop
