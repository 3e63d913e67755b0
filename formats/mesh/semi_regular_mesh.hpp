#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "formats/mesh/triangle_mesh.hpp"

namespace greenloop {

/// A surface with subdivision connectivity: base triangles split L times, every split at the edges' midpoints.
/// Vertices are stored coarse to fine, so the vertices of level l are the first vertex_end[l] ones: K(l) in the
/// notation of docs/theory.md, M(l) = K(l) \ K(l-1) the odd vertices that level l adds. Offline only.
struct SemiRegularMesh {
  std::vector<Eigen::Vector3d> positions;  ///< one per vertex, coarse to fine
  std::vector<std::size_t> vertex_end;     ///< vertex_end[l] = |K(l)|, l = 0..L; the last equals positions.size()
  std::vector<std::array<int, 2>>
      parents;  ///< the two ends of the parent edge, smaller index first; {-1, -1} in the base
  std::vector<std::array<int, 3>> base_triangles;  ///< over K(0), counter-clockwise from outside

  [[nodiscard]] int finest_level() const { return static_cast<int>(vertex_end.size()) - 1; }
};

/// The triangles of one level (0..finest_level), counter-clockwise; triangle t of level l has the children
/// 4t..4t+3 on level l + 1: three corner triangles (at its first, second, third vertex), then the middle one.
/// Work: linear in the number returned. Throws std::invalid_argument if an edge has no midpoint vertex.
[[nodiscard]] std::vector<std::array<int, 3>> triangles_of_level(const SemiRegularMesh& mesh, int level);

}  // namespace greenloop
