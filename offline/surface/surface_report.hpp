#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "formats/mesh/triangle_mesh.hpp"

namespace greenloop::offline {

/// A face counts as one of zero area where 2 A / lmax^2 (A its area, lmax its longest side) is at most this.
inline constexpr double smallest_quality = 1e-10;

/// What a surface is like. Every list is ordered; faces and vertices are indices into the mesh that was checked,
/// lengths in its unit.
struct SurfaceReport {
  std::size_t vertex_count = 0;
  std::size_t triangle_count = 0;
  Eigen::AlignedBox3d box;  ///< of all vertices

  std::vector<std::array<int, 2>> boundary_edges;      ///< edges of a single face
  std::vector<std::array<int, 2>> non_manifold_edges;  ///< edges of more than two faces
  std::vector<int> non_manifold_vertices;              ///< the faces around them do not form one fan
  std::vector<std::array<int, 2>> misoriented_edges;   ///< both faces run along them in the same direction
  std::vector<std::size_t> component_sizes;            ///< faces of each piece (connected by edges), largest first
  std::vector<int> component_first_face;               ///< smallest face index of each, in the same order
  std::vector<int> zero_area_faces;                    ///< see smallest_quality; repeated vertices too
  std::vector<std::array<int, 2>> duplicate_faces;     ///< {face, earlier face with the same three vertices}
  std::vector<int> unreferenced_vertices;              ///< in no face
  std::vector<std::array<int, 2>> duplicate_vertices;  ///< {vertex, first vertex at exactly the same position}
  std::vector<std::array<int, 2>> intersecting_faces;  ///< pairs that meet elsewhere than in common vertices or edges,
                                                       ///< not more than most_pairs

  int euler_characteristic = 0;  ///< V - E + F with V the vertices in use
  double volume = 0;             ///< signed; positive if faces look outwards; 0 if not closed and oriented
  double area = 0;
  double worst_quality = 0;  ///< smallest 2 A / lmax^2; sqrt(3)/2 for an equilateral triangle
  int worst_face = -1;       ///< where

  [[nodiscard]] bool closed() const { return boundary_edges.empty(); }
  [[nodiscard]] bool manifold() const { return non_manifold_edges.empty() && non_manifold_vertices.empty(); }
  [[nodiscard]] bool oriented() const { return misoriented_edges.empty(); }
  [[nodiscard]] bool inward() const { return volume < 0; }
  /// Handles, all pieces together; only meaningful for closed manifold surfaces.
  [[nodiscard]] int genus() const { return (2 * static_cast<int>(component_sizes.size()) - euler_characteristic) / 2; }
};

/// Examines a surface. Indices have to be in range (read_surface guarantees that).
/// Work: n log n for n faces if few intersect; 20,000 faces take well below a second.
[[nodiscard]] SurfaceReport check_surface(const TriangleMesh& mesh);

/// The same but for intersecting_faces, which stay unknown.
[[nodiscard]] SurfaceReport check_connectivity(const TriangleMesh& mesh);

/// True if every edge has two faces and the faces around each vertex form one ring. Work: n log n.
[[nodiscard]] bool is_closed_manifold(const TriangleMesh& mesh);

/// One line for each thing that keeps the surface from enclosing one solid: what, how many, where the first ones are,
/// how to mend it. Empty for a closed, manifold, outward oriented surface in one piece that does not intersect itself
/// and has no face of zero area.
[[nodiscard]] std::vector<std::string> describe_defects(const TriangleMesh& mesh, const SurfaceReport& report);

}  // namespace greenloop::offline
