#pragma once

#include <cstddef>

#include "formats/mesh/tetrahedral_mesh.hpp"
#include "formats/mesh/triangle_mesh.hpp"

namespace greenloop::offline {

/// Tetrahedra below this mean ratio count as slivers.
inline constexpr double kSliverQuality = 0.1;

struct TetrahedraQuality {
  double volume = 0.0;       ///< sum over the tetrahedra, unit of length cubed
  double min_quality = 1.0;  ///< smallest mean ratio 12 (3V)^(2/3) / sum of squared edges; 1 = regular, <= 0 = inverted
  std::size_t slivers = 0;   ///< tetrahedra below kSliverQuality
  std::size_t inverted = 0;  ///< tetrahedra without positive volume
  std::size_t interior_nodes = 0;  ///< vertices that lie on no boundary triangle
};

/// Volume and shape of every tetrahedron. Linear work. Throws std::invalid_argument on a vertex index out of range.
/// Mean ratio: Liu and Joe, BIT 34, 268 (1994).
[[nodiscard]] TetrahedraQuality measure_quality(const TetrahedralMesh& mesh);

/// The boundary triangles (faces of exactly one tetrahedron), counter-clockwise from outside, over the mesh's own
/// vertex numbers, in the order of the tetrahedra. Work O(n log n).
/// Throws std::runtime_error when a face belongs to more than two tetrahedra.
[[nodiscard]] std::vector<std::array<int, 3>> boundary_triangles(const TetrahedralMesh& mesh);

/// Throws std::runtime_error, naming the triangle, vertex or tetrahedron, unless `mesh` fills `surface` exactly: its
/// first vertices are the surface's, bit for bit; its boundary triangles are the surface's; every tetrahedron has
/// positive volume; the volumes agree to 1e-9.
void require_fills_surface(const TetrahedralMesh& mesh, const TriangleMesh& surface);

}  // namespace greenloop::offline
