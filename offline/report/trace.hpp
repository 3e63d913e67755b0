#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace greenloop::offline {

/// One probe (finger, tool) in one cycle.
struct ProbeState {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< m
  Eigen::Vector3d force = Eigen::Vector3d::Zero();   ///< N, on the probe
};

/// One cycle of the control loop, as greenloop-loop --trace wrote it.
struct TraceCycle {
  double time = 0;                      ///< s
  std::vector<ProbeState> probes = {};  ///< the same number in every cycle
  double force = 0;                     ///< N, sum of the magnitudes over the probes
  std::uint64_t contacts = 0;
  std::uint64_t level = 0;  ///< constraint level
  std::uint64_t field_level = 0;
  std::uint64_t work = 0;    ///< units spent
  std::uint64_t budget = 0;  ///< units allowed
  std::string status;

  /// Refused: the last good response was held.
  [[nodiscard]] bool held() const { return status.starts_with("held"); }
  [[nodiscard]] bool missed() const { return work > budget || held(); }
};

/// Reads a trace by column name: time; x0, y0, z0, force_x0, force_y0, force_z0 of the first probe and so on for x1 ..;
/// force, contacts, level, field_level, work, budget, status; others are left alone. Throws std::runtime_error with
/// file, line, column and value if a column is missing, a cell does not parse, there is no cycle, time does not
/// increase, or a level is none that a model can have.
[[nodiscard]] std::vector<TraceCycle> load_trace(const std::filesystem::path& path);

/// What a trace comes to.
struct TraceSummary {
  std::size_t cycles = 0;
  double duration = 0;     ///< s, first to last cycle
  std::size_t misses = 0;  ///< cycles beyond their budget or held
  std::size_t held = 0;
  std::size_t in_contact = 0;  ///< cycles with at least one contact
  std::size_t strongest = 0;   ///< index of the cycle of largest force
  std::uint64_t most_contacts = 0;
  std::uint64_t worst_work = 0;
  double worst_share = 0;                         ///< largest work / budget
  std::vector<std::size_t> cycles_at_level = {};  ///< by constraint level: answered cycles in contact
};

/// `trace` has at least one cycle.
[[nodiscard]] TraceSummary summarise(const std::vector<TraceCycle>& trace);

/// Reads node, x, y, z (file index; m) of a displaced body of `node_count` nodes; nodes that are not listed are at
/// rest. Throws std::runtime_error with file, line, column and value, also for a node twice or beyond the model.
[[nodiscard]] std::vector<Eigen::Vector3d> load_snapshot(const std::filesystem::path& path, std::size_t node_count);

}  // namespace greenloop::offline
