#pragma once

#include "offline/volume/tetrahedralize.hpp"

namespace greenloop::offline {

/// Whether there is a program named `tetgen` on PATH.
[[nodiscard]] bool tetgen_is_installed();

/// One attempt with the separate program `tetgen`, run in a temporary folder; unchecked. Its licence (AGPL) forbids
/// linking it. Throws std::runtime_error with its exit status when it fails.
[[nodiscard]] TetrahedralMesh mesh_with_tetgen(const TriangleMesh& surface);

}  // namespace greenloop::offline
