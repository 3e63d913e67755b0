#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "sim_hw/control_loop/cycle_tally.hpp"
#include "sim_hw/motion/motion_bounds.hpp"
#include "sim_hw/motion/motion_loop.hpp"

namespace greenloop {

/// What one cycle of the loop did.
struct MotionRecord {
  std::int64_t cycle = 0;
  std::int32_t impulse = -1;  ///< that the device gave
  ImpulseResponse::StepReport report;
  double position = 0;  ///< m, |q_u|
  double velocity = 0;  ///< m/s, |q_v|
};

/// What all cycles of a run come to; a miss is one that spent more than its budget, or had too little of it. Norms are
/// Euclidean, over the modes.
struct MotionTally : CycleTally {
  std::int64_t entered = 0;              ///< impulses that were followed
  std::int64_t blending = 0;             ///< of these, while an earlier difference was left
  std::int64_t continued = 0;            ///< orbits that went on in others
  std::int64_t illegal = 0;              ///< impulses that may not follow, refused
  std::int64_t unknown = 0;              ///< impulses that the palette does not have, refused
  std::int64_t not_held = 0;             ///< refusals after which the state was another one
  std::int64_t frames = 0, coarser = 0;  ///< of all vertices; of these by fewer modes
  std::uint32_t least_rank = 0;          ///< modes of the coarsest frame; 0: there was none
  double truncation_error = 0;           ///< the largest of a frame
  double blend = 0;                      ///< m, largest difference that had to die out
  double position_jump = 0;              ///< m, largest change of q_u in a cycle that went over to another orbit
  double velocity_jump = 0;              ///< m/s, the same of q_v
  double position_step = 0;              ///< m, largest change of q_u in any other
  double velocity_step = 0;              ///< m/s
  double energy = 0;                     ///< m^2, largest |q_u|^2 + rho^2 |q_v|^2
};

/// Everything a run of motions is judged and drawn by. All memory is taken at start-up.
class MotionLog {
 public:
  /// keep: the records of all cycles, too, which a trace is written of.
  MotionLog(std::size_t cycles, std::size_t modes, float velocity_balance, bool keep);

  /// Adds the last cycle of `loop`; beyond the cycles announced nothing is added. No heap.
  void add(const MotionLoop& loop, std::int64_t cycle, double cpu_us) noexcept;

  [[nodiscard]] const MotionTally& tally() const { return tally_; }
  [[nodiscard]] const std::vector<float>& cpu_us() const { return cpu_us_; }  ///< of each cycle

  /// One line per cycle: time in s, impulse (-1: none), orbit, row, position, velocity, blend and distance in m and
  /// m/s, rank, truncation_error, work, budget, status. Throws std::runtime_error if the file cannot be written.
  void write_trace(const std::filesystem::path& file, double period, std::uint64_t budget) const;

 private:
  void count(const MotionLoop& loop) noexcept;
  void compare(const MotionLoop& loop) noexcept;

  double balance_;
  std::vector<MotionRecord> records_;
  std::vector<float> cpu_us_;
  std::vector<float> coordinate_, velocity_;  // of the cycle before
  bool is_known_ = false;                     // whether there was an answer
  float blend_ = 0;                           // m, of the last one
  MotionTally tally_;
};

}  // namespace greenloop
