#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "sim_hw/control_loop/cycle_tally.hpp"
#include "sim_hw/drag/drag_loop.hpp"

namespace greenloop {

/// What one cycle of the loop did.
struct DragRecord {
  std::int64_t cycle = 0;
  std::int32_t vertex = -1;  ///< that the tool held
  double force = 0;          ///< N, of the tool
  double farthest = 0;       ///< m, largest displacement
  Multigrid::Energy energy;
  Multigrid::StepReport report;
};

/// What all cycles of a run come to; a miss is one that spent more than its budget, or had too little of it.
struct DragTally : CycleTally {
  std::int64_t grasps = 0;   ///< times that the tool took hold
  std::int64_t coarser = 0;  ///< cycles whose residual was above the tolerance
  std::int64_t refused = 0;  ///< cycles that were not answered, but for misses
  std::uint64_t multigrid_cycles = 0;
  std::uint32_t most_multigrid_cycles = 0;  ///< of a step
  double residual = 0;                      ///< the largest, relative
  double residual_sum = 0;                  ///< of all that were answered
  double force = 0;                         ///< N, the largest of the tool
  double farthest = 0;                      ///< m, the largest displacement
  double kinetic = 0, elastic = 0;          ///< J, the largest
  double kinetic_left = 0;                  ///< J, of the last cycle
  double gain = 0;  ///< J, the most that kinetic, elastic and gravity's energy came to beyond what the tool did

  [[nodiscard]] double mean_residual() const;
  [[nodiscard]] double mean_multigrid_cycles() const;
};

/// Everything a run of a dragged body is judged and drawn by. All memory is taken at start-up.
class DragLog {
 public:
  DragLog() = default;
  /// keep: the records of all cycles, too, which a trace is written of.
  DragLog(const MultigridView& view, std::size_t cycles, bool keep);

  /// Adds the last cycle of `loop`; beyond the cycles announced nothing is added. No heap; work: linear in the body.
  void add(const DragLoop& loop, std::int64_t cycle, double cpu_us) noexcept;

  [[nodiscard]] const DragTally& tally() const { return tally_; }
  [[nodiscard]] const std::vector<float>& cpu_us() const { return cpu_us_; }  ///< of each cycle
  /// m, of the shown surface when the body was deformed most by the tool; zero: it never was.
  [[nodiscard]] const std::vector<Vec3>& dragged() const { return dragged_; }

  /// One line per cycle: time in s, vertex (-1: none), force in N, displacement in m, kinetic and elastic energy in J,
  /// residual, cycles, work, budget, status. Throws std::runtime_error if the file cannot be written.
  void write_trace(const std::filesystem::path& file, double period, std::uint64_t budget) const;

  /// One line per vertex of the shown surface: its displacement x, y, z in m, as `dragged` has it. Throws
  /// std::runtime_error if the file cannot be written.
  void write_snapshot(const std::filesystem::path& file) const;

 private:
  void count(const DragLoop& loop) noexcept;
  void measure(const DragLoop& loop, const Multigrid::Energy& energy, double farthest) noexcept;
  [[nodiscard]] double weighed(std::span<const Vec3> displacement) const noexcept;

  std::vector<Vec3> weight_;  // N, of each vertex
  std::vector<DragRecord> records_;
  std::vector<float> cpu_us_;
  std::vector<Vec3> dragged_;
  double dragged_force_ = 0;  // N, at that time
  std::int32_t held_ = -1;    // in the cycle before
  Vec3 force_{}, place_{};    // of the tool in it
  double done_ = 0;           // J, by the tool
  DragTally tally_;
};

}  // namespace greenloop
