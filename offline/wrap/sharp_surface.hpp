#pragma once

#include <cstddef>
#include <vector>

#include "formats/mesh/triangle_mesh.hpp"
#include "offline/remesh/triangle_tree.hpp"
#include "offline/wrap/level_set.hpp"

namespace greenloop::offline {

/// A surface near another.
struct SharpSurface {
  TriangleMesh mesh;
  std::vector<bool> follows;  ///< per vertex, whether it lies on the original: not over a closed hole
  std::size_t held_back = 0;  ///< vertices that would have made faces cross or fold
};

/// Moves the vertices of a zero_surface onto the original surface: where its sharp edges and corners pass through a
/// vertex's cell, onto them (the quadric of the planes around; Ju, Losasso, Schaefer, Warren, "Dual contouring of
/// Hermite data", 2002), else to the closest point in the cell. Vertices over closed holes come to lie evenly.
/// Faces are split along the diagonal that is nearer to the original. Vertices of faces that cross others or fold go
/// back to where they were. Work: n log n.
[[nodiscard]] SharpSurface sharpen(const QuadSurface& surface, const TriangleMesh& original, const TriangleTree& tree);

/// The surface as it is, its faces split along the shorter diagonal, but for vertices of faces that cross or fold.
[[nodiscard]] SharpSurface split_quads(const QuadSurface& surface);

}  // namespace greenloop::offline
