#pragma once

#include <vector>

#include "formats/layout.hpp"
#include "formats/mesh/semi_regular_mesh.hpp"
#include "offline/scene/scene.hpp"

namespace greenloop::offline {

/// For every vertex of the author's surface, in the order of its file, the nearest point of the model's finest level.
/// Reads the file. Work: vertices times about the logarithm of the triangles. Throws what read_surface throws.
[[nodiscard]] std::vector<layout::VertexRecord> vertex_map(const MeshSource& source, const SemiRegularMesh& model);

}  // namespace greenloop::offline
