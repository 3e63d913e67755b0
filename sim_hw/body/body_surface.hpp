#pragma once

#include <cstdint>
#include <vector>

#include "runtime/algebra/double3.hpp"
#include "runtime/model.hpp"
#include "runtime/surface.hpp"

namespace greenloop {

/// The undeformed surface of a model at its finest level, as a device and a collision test need it. Start-up only.
struct BodySurface {
  std::vector<Double3> position;             ///< [node_count] m, by file index
  std::vector<Double3> normal;               ///< [node_count] outward unit normals, weighted by area
  std::vector<bool> touchable;               ///< [node_count]
  std::vector<Surface::Triangle> triangles;  ///< counter-clockwise from outside
  Double3 centre;                            ///< m, of the bounding box
  double diagonal = 0;                       ///< m, of the bounding box
  double spacing = 0;                        ///< m, mean length of the triangles' edges
};

/// The surface of a model at its finest level. Throws std::runtime_error if its refinement is not that of a subdivided
/// triangulation, or nothing can be touched.
[[nodiscard]] BodySurface body_surface(const Model& model);

}  // namespace greenloop
