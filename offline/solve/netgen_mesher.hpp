#pragma once

#include "offline/solve/tetrahedralize.hpp"

namespace greenloop::offline {

/// One attempt with linked Netgen; unchecked. Throws std::runtime_error with Netgen's reason when it fails.
[[nodiscard]] TetrahedralMesh mesh_with_netgen(const TriangleMesh& surface, const TetrahedralizeOptions& options);

}  // namespace greenloop::offline
