#pragma once

#include "formats/mesh/semi_regular_mesh.hpp"
#include "formats/mesh/triangle_mesh.hpp"
#include "formats/view.hpp"

namespace greenloop {

/// The undeformed surface of a verified model, vertex i being the node of file index i. Offline only.
[[nodiscard]] SemiRegularMesh semi_regular_surface(const ElastostaticView& view);

/// Its finest level present as plain triangles, in metres. Work: linear in the nodes, times a logarithm.
/// Throws std::invalid_argument if the nodes' parents do not make up a subdivided surface.
[[nodiscard]] TriangleMesh finest_surface(const ElastostaticView& view);

}  // namespace greenloop
