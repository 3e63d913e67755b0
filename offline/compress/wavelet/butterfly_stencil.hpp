#pragma once

#include <vector>

#include "formats/layout.hpp"
#include "formats/mesh/semi_regular_mesh.hpp"

namespace greenloop::offline {

/// The Butterfly stencils (Dyn, Levin & Gregory 1990, section 2) of the nodes of M(level), in node order, over the
/// triangles of K(level - 1); all layout::none where an edge of the stencil has not exactly two triangles, as on a
/// border. 1 <= level. Work: n log n. Offline only.
[[nodiscard]] std::vector<layout::StencilRecord> butterfly_stencils(const SemiRegularMesh& mesh, std::size_t level);

/// No stencil: prediction from the two parents alone.
inline constexpr layout::StencilRecord no_stencil{{layout::none, layout::none},
                                                  {layout::none, layout::none, layout::none, layout::none}};

[[nodiscard]] inline bool has_stencil(const layout::StencilRecord& stencil) { return stencil.wing[0] != layout::none; }

}  // namespace greenloop::offline
