#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "formats/mesh/tetrahedral_mesh.hpp"

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

/// Of the vertices of a mesh. `young`: Pa, one a tetrahedron. Work: tetrahedra, and sorting their faces where not all
/// are about as stiff. Throws std::invalid_argument on another number of moduli, or none.
[[nodiscard]] VertexStiffness vertex_stiffness(const TetrahedralMesh& mesh, std::span<const double> young);

}  // namespace greenloop::offline
