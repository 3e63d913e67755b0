#include "offline/reduce/penetration.hpp"

#include <algorithm>
#include <utility>

#include "offline/surface/triangle_intersection.hpp"

namespace greenloop::offline {

PenetrationCounter::PenetrationCounter(const std::vector<std::uint32_t>& triangles, std::vector<RigidShape> rigid)
    : rigid_(std::move(rigid)) {
  for (std::size_t i = 0; i + 2 < triangles.size(); i += 3) {
    mesh_.triangles.push_back(
        {static_cast<int>(triangles[i]), static_cast<int>(triangles[i + 1]), static_cast<int>(triangles[i + 2])});
  }
}

void PenetrationCounter::add(std::span<const float> positions) {
  mesh_.vertices.clear();
  for (std::size_t i = 0; i + 2 < positions.size(); i += 3) {
    mesh_.vertices.emplace_back(positions[i], positions[i + 1], positions[i + 2]);
  }
  const auto crossings = self_intersections(mesh_, std::vector<bool>(mesh_.triangles.size())).size();
  double deepest = 0;
  for (const auto& vertex : mesh_.vertices) {
    for (const RigidShape& shape : rigid_) deepest = std::max(deepest, -clearance(shape, vertex).distance);
  }
  ++count_.frames;
  count_.crossings += crossings;
  count_.crossing_frames += crossings > 0 ? 1 : 0;
  count_.inside_frames += deepest > 0 ? 1 : 0;
  count_.deepest = std::max(count_.deepest, deepest);
}

}  // namespace greenloop::offline
