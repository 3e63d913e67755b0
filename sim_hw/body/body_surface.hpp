#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "formats/view.hpp"
#include "runtime/algebra/double3.hpp"

namespace greenloop {

/// The undeformed surface of a model at its finest level, as a device and a collision test need it. Start-up only.
struct BodySurface {
  std::vector<Double3> position;                        ///< [node_count] m, by file index
  std::vector<Double3> normal;                          ///< [node_count] outward unit normals, weighted by area
  std::vector<bool> touchable;                          ///< [node_count]
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< counter-clockwise from outside
  Double3 centre;                                       ///< m, of the bounding box
  double diagonal = 0;                                  ///< m, of the bounding box
  double spacing = 0;                                   ///< m, mean length of the triangles' edges

  /// Those that are touchable, increasing.
  [[nodiscard]] std::vector<std::uint32_t> touchable_nodes() const;
};

/// Rebuilds the surface by splitting the base triangles at the model's refinement nodes.
/// Throws std::runtime_error if an edge has no midpoint or nothing can be touched.
[[nodiscard]] BodySurface body_surface(const ModelView& model);

}  // namespace greenloop
