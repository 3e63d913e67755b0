#pragma once

#include "offline/volume/tetrahedralize.hpp"

namespace greenloop::offline {

/// One attempt with linked Netgen; unchecked. Its interior nodes start from a grid of boxes, and symmetric shapes in
/// line with the grid can come out badly shaped: `turn` radians of rotation against it give another result. Throws
/// std::runtime_error with Netgen's reason when it fails.
[[nodiscard]] TetrahedralMesh mesh_with_netgen(const TriangleMesh& surface, const TetrahedralizeOptions& options,
                                               double turn);

}  // namespace greenloop::offline
