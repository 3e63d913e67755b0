#include "offline/scene/scene.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <utility>

namespace greenloop::offline {
namespace {

std::string lines(const std::vector<std::string>& problems) {
  std::string text;
  for (const auto& problem : problems) {
    text += (text.empty() ? "" : "\n") + problem;
  }
  return text;
}

std::string box_text(const Eigen::AlignedBox3d& box) {
  std::array<char, 192> text{};
  std::snprintf(text.data(), text.size(), "(%.6g, %.6g, %.6g) m to (%.6g, %.6g, %.6g) m", box.min().x(), box.min().y(),
                box.min().z(), box.max().x(), box.max().y(), box.max().z());
  return text.data();
}

/// The nodes of some regions, of all nodes if there are none, among those that `allowed` leaves.
NodeSet nodes_of(const std::vector<Region>& regions, const std::vector<bool>& allowed,
                 std::span<const Eigen::Vector3d> positions, const Eigen::AlignedBox3d& box) {
  NodeSet set;
  set.holds = regions.empty() ? allowed : std::vector<bool>(positions.size(), false);
  for (const auto& region : regions) {
    const auto flags = evaluate(region, positions, box);
    std::size_t nodes = 0;
    for (std::size_t i = 0; i < flags.size(); ++i) {
      const bool held = flags[i] && allowed[i];
      nodes += held ? 1 : 0;
      set.holds[i] = set.holds[i] || held;
    }
    set.of_region.push_back(nodes);
  }
  return set;
}

/// Names every region of a role that holds no node.
void name_empty_regions(const std::string& role, const NodeSet& set, const std::string& none,
                        std::vector<std::string>& problems) {
  const std::size_t regions = set.of_region.size();
  for (std::size_t k = 0; k < regions; ++k) {
    if (set.of_region[k] > 0) continue;
    const std::string which = regions == 1 ? "" : " " + std::to_string(k + 1) + " of " + std::to_string(regions);
    problems.push_back(role + which + ": the region holds none of the " + none);
  }
}

/// Names every pressure that acts on no node, or on some that nothing is stored of.
void name_unstored_pressures(const Scene& scene, const NodeSets& sets, std::span<const Eigen::Vector3d> positions,
                             const Eigen::AlignedBox3d& box, std::vector<std::string>& problems) {
  for (const PressureLoad& load : scene.pressures) {
    const auto pressure = node_pressures(load, positions, box);
    std::size_t pressed = 0, movable = 0, unstored = 0;
    for (std::size_t i = 0; i < pressure.size(); ++i) {
      pressed += pressure[i] > 0 ? 1 : 0;
      if (pressure[i] == 0 || sets.fixed.holds[i]) continue;
      ++movable;
      unstored += sets.touched.holds[i] || sets.read.holds[i] ? 0 : 1;
    }
    const std::string which = "loads: \"" + load.name + "\": the region holds ";
    if (movable == 0 || (!load.mask && pressed < 3)) {
      problems.push_back(which + "no triangle that can move; the bounding box goes from " + box_text(box));
    } else if (unstored > 0) {
      problems.push_back(which + std::to_string(unstored) + " nodes that are neither touched nor read, of " +
                         std::to_string(movable) + " that can move; add the region as one of [[read]]");
    }
  }
}

}  // namespace

std::vector<double> node_pressures(const PressureLoad& load, std::span<const Eigen::Vector3d> positions,
                                   const Eigen::AlignedBox3d& box) {
  if (load.mask) return linear_mask(std::get<SphereRegion>(load.region), positions, box);
  const auto pressed = evaluate(load.region, positions, box);
  return {pressed.begin(), pressed.end()};
}

SceneError::SceneError(std::vector<std::string> problems)
    : std::runtime_error(lines(problems)), problems_(std::move(problems)) {}

double MeshSource::scale(const Eigen::AlignedBox3d& mesh_box) const {
  if (unit) {
    return *unit;
  }
  const double longest = mesh_box.isEmpty() ? 0 : mesh_box.sizes().maxCoeff();
  if (!(longest > 0)) {
    throw SceneError({name + ": the mesh has no extent that could be scaled to size"});
  }
  return *size / longest;
}

std::optional<std::int64_t> StepBudget::asked_work() const {
  return work || !share ? work : std::optional<std::int64_t>(std::llround(step_us() * speed()));
}

std::size_t NodeSet::count() const { return static_cast<std::size_t>(std::count(holds.begin(), holds.end(), true)); }

NodeSets select_nodes(const Scene& scene, std::span<const Eigen::Vector3d> positions, const Eigen::AlignedBox3d& box) {
  NodeSets sets;
  sets.fixed = nodes_of(scene.fixed, std::vector<bool>(positions.size(), true), positions, box);
  std::vector<bool> movable = sets.fixed.holds;
  movable.flip();
  sets.touched = nodes_of(scene.touched, movable, positions, box);
  sets.read = nodes_of(scene.read, movable, positions, box);

  const auto total = std::to_string(positions.size());
  const auto fixed = sets.fixed.count();
  const auto where = "; the bounding box goes from " + box_text(box);
  if (fixed == positions.size()) {
    throw SceneError({"fixed: the regions hold all " + total + " nodes, so nothing can move" + where});
  }
  std::vector<std::string> problems;
  name_empty_regions("fixed", sets.fixed, total + " nodes" + where, problems);
  const auto none = std::to_string(positions.size() - fixed) + " nodes that can move (" + std::to_string(fixed) +
                    " of " + total + " are fixed)" + where;
  name_empty_regions("touched", sets.touched, none, problems);
  name_empty_regions("read", sets.read, none, problems);
  name_unstored_pressures(scene, sets, positions, box, problems);
  if (!problems.empty()) {
    throw SceneError(std::move(problems));
  }
  return sets;
}

}  // namespace greenloop::offline
