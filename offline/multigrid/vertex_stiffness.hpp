#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "formats/mesh/tetrahedral_mesh.hpp"
#include "offline/multigrid/tetrahedron_grid.hpp"

namespace greenloop::offline {

/// How stiff a body is where each vertex of a level stands, and of which piece.
struct VertexStiffness {
  /// Pa, of the stiffest matter around; what is this much softer follows what is stiffer, not the other way round.
  std::vector<double> young;
  std::vector<std::uint32_t> piece;  ///< vertices of one number hang together by matter of about their stiffness

  static constexpr double contrast = 100.0;

  /// Whether a vertex of one may take part of its displacement from one of the other.
  [[nodiscard]] bool follows(std::uint32_t vertex, const VertexStiffness& other, std::uint32_t other_vertex) const;
};

/// The matter of a body: Young's modulus of each tetrahedron of its finest mesh. Refers to both.
class Matter {
 public:
  /// `young`: Pa, one a tetrahedron. Work: tetrahedra. Throws std::invalid_argument on another number of them.
  Matter(const TetrahedralMesh& mesh, std::span<const double> young);

  /// Of the mesh's own vertices.
  [[nodiscard]] VertexStiffness at_vertices() const;
  /// Of points: what the tetrahedron around, or the nearest one, is made of; where it stands on several, the stiffest.
  [[nodiscard]] VertexStiffness at(std::span<const Eigen::Vector3d> points, const TetrahedronGrid& grid) const;

 private:
  const TetrahedralMesh& mesh_;
  std::span<const double> young_;
  std::vector<std::uint32_t> piece_;  // of each tetrahedron
};

}  // namespace greenloop::offline
