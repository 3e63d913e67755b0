#pragma once

#include <cstdint>
#include <vector>

#include "formats/store/elements.hpp"
#include "offline/sources/fem/elasticity.hpp"
#include "offline/sources/fem/quadratic_elements.hpp"
#include "offline/volume/boundary_interpolation.hpp"

namespace greenloop::offline {

/// A body of tetrahedra of one material and the surface that hangs on it.
struct FemProblem {
  const TetrahedralMesh& volume;           ///< m
  const std::vector<std::uint8_t>& fixed;  ///< per vertex, nonzero = fixed
  const Interpolation& interpolation;      ///< surface nodes from vertices
  Material material;
  const std::vector<int>& row_nodes;     ///< of the surface, strictly increasing
  const std::vector<int>& column_nodes;  ///< likewise
  Elements elements = Elements::linear;
};

/// What moves in a problem. `edges`: of its volume.
[[nodiscard]] FreePoints free_points(const FemProblem& problem, const MeshEdges& edges);

/// Lower triangle of the stiffness matrix over the free points, N/m. Throws std::invalid_argument on a tetrahedron
/// without positive volume, or a material out of range.
[[nodiscard]] Eigen::SparseMatrix<double> assemble_stiffness(const FemProblem& problem, const MeshEdges& edges,
                                                             const FreePoints& free);

/// Surface nodes from free points: B of U = B K^-1 B^T (theory.md, section 1). With linear elements the problem's
/// interpolation. Quadratic displacements are read at a vertex of the boundary as what the vertex has and the mean of
/// what the edges around it add, weighted by the vertex's linear function on the boundary: exact for linear
/// displacements. The transpose spreads a force over that neighbourhood, since quadratic elements yield without bound
/// to one at a point.
[[nodiscard]] Interpolation nodes_from_points(const FemProblem& problem, const MeshEdges& edges,
                                              const FreePoints& free);

/// The integral of each free point's function over the body, m^3: what a uniform force of 1 N/m^3 pulls it with, N.
[[nodiscard]] Eigen::VectorXd point_volumes(const FemProblem& problem, const MeshEdges& edges, const FreePoints& free);

}  // namespace greenloop::offline
