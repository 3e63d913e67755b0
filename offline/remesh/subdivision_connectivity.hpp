#pragma once

#include <optional>

#include "formats/mesh/semi_regular_mesh.hpp"
#include "formats/mesh/triangle_mesh.hpp"

namespace greenloop::offline {

/// Finds out whether a closed, connected, manifold mesh is a coarser one split at its edges' midpoints (1 to 4), in
/// whatever order its vertices are, and if so returns it as such, every vertex where it was: as many levels as there
/// are, `most_levels` at most; nothing if there is none. Three of the four triangles around any one triangle, or that
/// triangle itself, can be the middle one of a split, and each choice settles the rest of the surface, so at most four
/// candidates per level are followed (Taubin, "Detecting and reconstructing subdivision connectivity", 2002, covers
/// the surface likewise). Among equally deep ones the one whose odd vertices are closest to midpoints is taken.
/// Work: linear in the triangles times the levels. Throws std::invalid_argument if the mesh is not closed or manifold.
[[nodiscard]] std::optional<SemiRegularMesh> find_subdivision_connectivity(const TriangleMesh& mesh, int most_levels);

}  // namespace greenloop::offline
