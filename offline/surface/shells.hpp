#pragma once

#include <cstddef>
#include <vector>

#include "formats/mesh/triangle_mesh.hpp"

namespace greenloop::offline {

/// Cavities that a body may have.
inline constexpr std::size_t most_cavities = 64;

/// What bounds a body with cavities, each shell a closed surface of its own that looks outwards.
struct Shells {
  TriangleMesh skin;                   ///< encloses all others
  std::vector<TriangleMesh> cavities;  ///< by falling volume
};

/// Splits a closed, manifold, consistently oriented surface that does not intersect itself. Throws std::runtime_error,
/// naming a place, if a piece does not lie within the one that encloses most, or lies within another cavity, where it
/// would be a body of its own, and if there are more than most_cavities. Work: linear in the faces, for every cavity.
[[nodiscard]] Shells split_shells(const TriangleMesh& mesh);

/// The walls of cavities as one mesh that looks into them, out of the material.
[[nodiscard]] TriangleMesh walls_of(const std::vector<TriangleMesh>& cavities);

/// The closed pieces that look into what they enclose, with all vertices of the mesh. Linear work.
[[nodiscard]] TriangleMesh inward_pieces(const TriangleMesh& mesh);

/// What they enclose, in the cube of their unit. Linear work.
[[nodiscard]] double volume_of_all(const std::vector<TriangleMesh>& cavities);

/// Faces of both, those of `b` with vertices after those of `a`.
[[nodiscard]] TriangleMesh joined(TriangleMesh a, const TriangleMesh& b);

}  // namespace greenloop::offline
