#pragma once

#include "formats/mesh/triangle_mesh.hpp"

namespace greenloop::offline {

/// Area of all triangles, in the square of the mesh's unit. Linear work.
[[nodiscard]] double surface_area(const TriangleMesh& mesh);

/// Volume enclosed by a closed surface (divergence theorem), in the cube of its unit; negative where its triangles face
/// inwards. Linear work.
[[nodiscard]] double enclosed_volume(const TriangleMesh& mesh);

}  // namespace greenloop::offline
