#pragma once

#include <cstdint>
#include <vector>

#include "formats/mesh/tetrahedral_mesh.hpp"

namespace greenloop::offline {

/// Throws std::runtime_error unless every piece of the mesh (tetrahedra connected through faces) has three fixed
/// vertices that are not on one line, so that it cannot move rigidly; the message gives a vertex of the loose piece.
/// One byte per vertex in `fixed`, nonzero = fixed. Work O(n log n).
void require_no_rigid_motion(const TetrahedralMesh& mesh, const std::vector<std::uint8_t>& fixed);

}  // namespace greenloop::offline
