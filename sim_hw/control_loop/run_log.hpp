#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "sim_hw/control_loop/control_loop.hpp"
#include "sim_hw/control_loop/cycle_tally.hpp"

namespace greenloop {

/// What one cycle of the loop did.
struct CycleRecord {
  std::int64_t cycle = 0;
  Budget budget;
  std::array<Double3, max_tools> centre{};          ///< m, of the probes
  std::array<Double3, max_tools> hand_force{};      ///< N, on the probes
  std::array<Double3, max_tools> hand_torque{};     ///< N m, on the probes about their centres
  bool between = false;                             ///< two steps of the body, by its local model
  std::array<std::uint32_t, max_tools> touching{};  ///< places where each probe pushes the body
  std::uint32_t contacts = 0;                       ///< all that push
  std::array<bool, max_tools> behind{};             ///< probes that came to be behind the surface of the last cycle
  std::uint64_t touching_bound = 0;                 ///< units, of report.touching_work
  ContactBody::StepReport report;
  ContactBody::Energy energy;
  double cpu_us = 0;  ///< thread CPU time of the cycle

  /// N, sum of the magnitudes: two fingers of a grasp do not cancel.
  [[nodiscard]] double total_force() const {
    double sum = 0;
    for (const Double3& force : hand_force) sum += norm(force);
    return sum;
  }
  [[nodiscard]] bool missed() const {
    return report.work > budget.work || report.touching_work > touching_bound || !answered(report.status);
  }
};

/// What a local model gives between steps against stepping the body as fast, all N of one probe.
struct FastLoop {
  std::int64_t cycles = 0;       ///< in contact, between steps
  std::int64_t in_range = 0;     ///< of these, within the local model's range
  double square = 0;             ///< of the reference's force, summed over these
  double error_square = 0;       ///< of the difference
  double held_square = 0;        ///< of what holding the last step's force would be off by
  double step_square = 0;        ///< of the reference's force, in the cycles of steps
  double step_error_square = 0;  ///< of what the step's force is off by there: slips of other steps
  double error_most = 0, held_most = 0, force_most = 0;
  std::uint64_t work_most = 0;  ///< units, of making a local model

  [[nodiscard]] static double relative(double squares, double of) { return of > 0 ? std::sqrt(squares / of) : 0; }
};

/// What the motions of a vibrating body come to.
struct MotionsGiven {
  std::int64_t followed = 0, illegal = 0, unknown = 0;  ///< impulses; the last two were refused
  std::int64_t coarser = 0;                             ///< cycles by fewer modes than the model has
  double offset = 0;                                    ///< m, the farthest that a node moved by them

  void add(const ControlLoop& loop) noexcept;
};

/// What all cycles of a run come to; a miss is a cycle that was CycleRecord::missed.
struct RunTally : CycleTally {
  std::int64_t contact_cycles = 0;
  std::uint32_t contacts_max = 0;
  double force_max = 0;              ///< N
  CycleRecord strongest;             ///< the cycle in which it was
  CycleRecord last;                  ///< the cycle before
  double force_step_max = 0;         ///< N, of a probe's force from a cycle to the next
  double residual_max = 0;           ///< of the contact laws
  std::int64_t fall_throughs = 0;    ///< probes and cycles that a probe spent behind the surface without a force and
                                     ///< left it there
  std::uint64_t worst_touching = 0;  ///< units, of finding what touches
  double handled = 0;                ///< J, the tools' work, in or out, summed over the cycles
  std::array<std::int64_t, layout::max_levels> at_level{};  ///< cycles by constraint level
  FastLoop fast;
  MotionsGiven motions;

  void add(const CycleRecord& record) noexcept;
};

/// Everything a run is judged and drawn by. All memory is taken at start-up.
class RunLog {
 public:
  /// keep: the records of all cycles, too, which a trace is written of.
  RunLog(std::size_t cycles, std::size_t nodes, bool keep = true);

  /// Adds the last cycle of `loop`; beyond the cycles announced nothing is added. No heap.
  void add(const ControlLoop& loop, std::int64_t cycle, double cpu_us) noexcept;

  [[nodiscard]] const std::vector<CycleRecord>& records() const { return records_; }  ///< empty unless kept
  [[nodiscard]] const RunTally& tally() const { return tally_; }
  [[nodiscard]] const std::vector<float>& cpu_us() const { return cpu_us_; }  ///< of each cycle

  /// One line per cycle: time in s, positions in m and forces in N of `probes` probes (at most max_tools). Numbers read
  /// back exactly. Throws std::runtime_error if the file cannot be written.
  void write_trace(const std::filesystem::path& file, std::size_t probes, double period) const;

  /// node, x, y, z: the displacement in m of every node in the cycle of the largest total force that had a field.
  void write_snapshot(const std::filesystem::path& file) const;

 private:
  void compare(const ControlLoop& loop) noexcept;

  std::vector<CycleRecord> records_;
  std::vector<float> cpu_us_;
  RunTally tally_;
  std::array<Double3, max_tools> stepped_force_{};  ///< N, of the last step
  std::vector<float> largest_field_;                ///< [4 * nodes] m
  double largest_force_ = -1;
};

}  // namespace greenloop
