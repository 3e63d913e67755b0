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

std::size_t count(const std::vector<bool>& flags) {
  return static_cast<std::size_t>(std::count(flags.begin(), flags.end(), true));
}

std::string box_text(const Eigen::AlignedBox3d& box) {
  std::array<char, 192> text{};
  std::snprintf(text.data(), text.size(), "(%.6g, %.6g, %.6g) m to (%.6g, %.6g, %.6g) m", box.min().x(), box.min().y(),
                box.min().z(), box.max().x(), box.max().y(), box.max().z());
  return text.data();
}

std::vector<bool> movable(const std::vector<Region>& regions, const std::vector<bool>& fixed,
                          std::span<const Eigen::Vector3d> positions, const Eigen::AlignedBox3d& box) {
  auto flags = regions.empty() ? std::vector<bool>(positions.size(), true) : evaluate(regions, positions, box);
  for (std::size_t i = 0; i < flags.size(); ++i) {
    flags[i] = flags[i] && !fixed[i];
  }
  return flags;
}

}  // namespace

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

NodeSets select_nodes(const Scene& scene, std::span<const Eigen::Vector3d> positions, const Eigen::AlignedBox3d& box) {
  NodeSets sets;
  sets.fixed = evaluate(scene.fixed, positions, box);
  sets.touched = movable(scene.touched, sets.fixed, positions, box);
  sets.read = movable(scene.read, sets.fixed, positions, box);

  const auto total = std::to_string(positions.size());
  const auto fixed_count = count(sets.fixed);
  const auto where = "; the bounding box goes from " + box_text(box);
  if (fixed_count == 0) {
    throw SceneError({"fixed: the regions hold none of the " + total + " nodes, so nothing holds the body" + where});
  }
  if (fixed_count == positions.size()) {
    throw SceneError({"fixed: the regions hold all " + total + " nodes, so nothing can move" + where});
  }
  const auto none = ": the regions hold none of the " + std::to_string(positions.size() - fixed_count) +
                    " nodes that can move (" + std::to_string(fixed_count) + " of " + total + " are fixed)" + where;
  std::vector<std::string> problems;
  if (count(sets.touched) == 0) {
    problems.push_back("touched" + none);
  }
  if (count(sets.read) == 0) {
    problems.push_back("read" + none);
  }
  if (!problems.empty()) {
    throw SceneError(std::move(problems));
  }
  return sets;
}

}  // namespace greenloop::offline
