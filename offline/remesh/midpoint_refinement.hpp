#pragma once

#include <array>
#include <vector>

#include "formats/mesh/semi_regular_mesh.hpp"
#include "offline/remesh/surface.hpp"

namespace greenloop::offline {

/// Base triangles split `levels` times, and where each vertex lies on the base.
struct MidpointRefinement {
  SemiRegularMesh mesh;              ///< connectivity; positions are left zero
  std::vector<SurfacePoint> places;  ///< one per vertex; SurfacePoint::triangle indexes mesh.base_triangles
};

/// Throws std::invalid_argument if two base edges have the same ends.
[[nodiscard]] MidpointRefinement refine_midpoints(const std::vector<std::array<int, 3>>& base_triangles,
                                                  int base_vertices, int levels);

/// The same mesh with its finest levels left out.
[[nodiscard]] SemiRegularMesh truncated(SemiRegularMesh mesh, int levels);

}  // namespace greenloop::offline
