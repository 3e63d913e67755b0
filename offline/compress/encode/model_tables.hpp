#pragma once

#include <cstdint>
#include <vector>

#include "formats/layout.hpp"
#include "formats/mesh/semi_regular_mesh.hpp"
#include "formats/write/writer.hpp"
#include "offline/compress/wavelet/surface_wavelet.hpp"

namespace greenloop::offline {

/// The part of a model that does not depend on its columns: info (`facts` completed), nodes, base triangles and
/// refinement. encode fills in the counts. `problem`: elastostatic, or scalar with Equilibrated predictions of numbers.
/// `flags` and `area` per node; a fixed node is not touchable in the model. Work: linear in the nodes. Offline only.
[[nodiscard]] ModelData describe_mesh(const SemiRegularMesh& mesh, const std::vector<std::uint32_t>& flags,
                                      const std::vector<double>& area, const SurfaceWavelet& wavelet,
                                      layout::Problem problem, const layout::Info& facts);

/// Adds the representatives of every constraint level from model.info.coarsest_constraint_level on, and moves that up
/// to the first level where a touchable node has one. Throws std::invalid_argument if there is none. Work: that of
/// representatives, per level. Offline only.
void add_representatives(const SemiRegularMesh& mesh, const std::vector<std::uint32_t>& flags, ModelData& model);

}  // namespace greenloop::offline
