#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "sim_hw/control_loop/control_loop.hpp"

namespace greenloop {

/// What one cycle of the loop did.
struct CycleRecord {
  std::int64_t cycle = 0;
  std::array<Double3, max_tools> centre{};          ///< m, of the probes
  std::array<Double3, max_tools> hand_force{};      ///< N, on the probes
  std::array<Double3, max_tools> hand_torque{};     ///< N m, on the probes about their centres
  std::array<std::uint32_t, max_tools> touching{};  ///< places where each probe pushes the body
  std::uint32_t contacts = 0;                       ///< all that push
  std::uint32_t fell_through = 0;                   ///< probes that are behind the surface and feel nothing
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
  [[nodiscard]] bool missed(const Budget& budget) const {
    return report.work > budget.work || report.touching_work > touching_bound || !answered(report.status);
  }
};

/// Everything a run is judged and drawn by. All memory is taken at start-up.
class RunLog {
 public:
  RunLog(std::size_t cycles, std::size_t nodes);

  /// Adds the last cycle of `loop`; beyond the cycles announced nothing is added. No heap.
  void add(const ControlLoop& loop, std::int64_t cycle, double cpu_us) noexcept;

  [[nodiscard]] const std::vector<CycleRecord>& records() const { return records_; }

  /// One line per cycle: time in s, positions in m and forces in N of `probes` probes (at most max_tools). Numbers read
  /// back exactly. Throws std::runtime_error if the file cannot be written.
  void write_trace(const std::filesystem::path& file, std::size_t probes, double period, const Budget& budget) const;

  /// node, x, y, z: the displacement in m of every node in the cycle of the largest total force that had a field.
  void write_snapshot(const std::filesystem::path& file) const;

 private:
  std::vector<CycleRecord> records_;
  std::vector<float> largest_field_;  ///< [4 * nodes] m
  double largest_force_ = -1;
};

}  // namespace greenloop
