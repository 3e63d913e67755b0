#pragma once

#include <cstdint>
#include <vector>

#include "formats/exchange/semi_regular_mesh.hpp"
#include "formats/layout.hpp"
#include "formats/writer.hpp"
#include "offline/compress/linear_wavelet.hpp"

namespace greenloop::offline {

/// The part of a model that does not depend on its columns: info (`facts` completed), nodes, base triangles and
/// refinement. encode fills in the counts. `flags` and `area` per node; a fixed node is not touchable in the model.
/// Work: linear in the nodes. Offline only.
[[nodiscard]] ModelData describe_mesh(const SemiRegularMesh& mesh, const std::vector<std::uint32_t>& flags,
                                      const std::vector<double>& area, const LinearWavelet& wavelet,
                                      const layout::Info& facts);

}  // namespace greenloop::offline
