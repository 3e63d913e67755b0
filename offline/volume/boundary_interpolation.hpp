#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <cstdint>
#include <vector>

#include "formats/mesh/tetrahedral_mesh.hpp"
#include "formats/mesh/triangle_mesh.hpp"

namespace greenloop::offline {

/// B of u_surface = B u_volume, one weight per pair of surface node and volume vertex, the same for every axis. Forces
/// go the other way, f_volume = B^T f_surface, so the compliance between surface nodes is B K^-1 B^T.
using Interpolation = Eigen::SparseMatrix<double, Eigen::RowMajor>;

/// Surface node i is volume vertex i: what tetrahedralize makes.
[[nodiscard]] Interpolation select_first_vertices(int surface_nodes, int volume_vertices);

/// The boundary of a volume as a surface of its own, vertices in the volume's order, and where they came from.
struct Boundary {
  TriangleMesh surface;
  std::vector<int> volume_vertex;  ///< per surface vertex
};
[[nodiscard]] Boundary extract_boundary(const TetrahedralMesh& volume);

/// The walls of the cavities in a volume, looking into them, as triangles of its vertices.
[[nodiscard]] TriangleMesh cavity_walls(const TetrahedralMesh& volume);

/// Barycentric weights of every node on the closest boundary triangle of the volume. Work O((n + m) log m).
/// Throws std::runtime_error, naming the node, when one lies further from the boundary than `tolerance` (m).
[[nodiscard]] Interpolation interpolate_on_boundary(const std::vector<Eigen::Vector3d>& nodes,
                                                    const TetrahedralMesh& volume, double tolerance);

/// Throws std::runtime_error when the compliance over `nodes` would be singular: more nodes than free boundary
/// vertices, a node that hangs on fixed vertices only, or nodes whose weights depend on each other. One byte per volume
/// vertex in `volume_fixed`, nonzero = fixed.
void require_independent(const Interpolation& interpolation, const std::vector<int>& nodes,
                         const std::vector<std::uint8_t>& volume_fixed);

}  // namespace greenloop::offline
