#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "formats/mesh/triangle_mesh.hpp"
#include "offline/scene/rigid_shape.hpp"

namespace greenloop::offline {

/// How often a surface crosses itself, or reaches into rigid shapes.
struct PenetrationCount {
  std::uint64_t frames = 0;           ///< looked at
  std::uint64_t crossing_frames = 0;  ///< in which triangles cross each other
  std::uint64_t crossings = 0;        ///< pairs of such triangles, of all frames
  std::uint64_t inside_frames = 0;    ///< in which vertices are inside rigid shapes
  double deepest = 0;                 ///< m, of these vertices
};

/// Counts them frame by frame.
class PenetrationCounter {
 public:
  PenetrationCounter(const std::vector<std::uint32_t>& triangles, std::vector<RigidShape> rigid);

  /// positions: m, [vertices][3]. Work: that of self_intersections, and vertices times shapes.
  void add(std::span<const float> positions);
  [[nodiscard]] const PenetrationCount& count() const { return count_; }

 private:
  TriangleMesh mesh_;
  std::vector<RigidShape> rigid_;
  PenetrationCount count_;
};

}  // namespace greenloop::offline
