#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "formats/mesh/semi_regular_mesh.hpp"

namespace greenloop::offline {

/// For every node, the domain node of K(level) that stands for it when a contact is resolved on that constraint level:
/// the one with the largest hat there (unlifted Linear subdivision; James & Pai 2003, section 6), or the nearest one if
/// no such hat reaches it. layout::none for nodes that are not touchable, and everywhere if K(level) has no domain
/// node. `flags`: layout::NodeFlag per node. Work: linear in the nodes, plus nodes without a hat times K(level).
[[nodiscard]] std::vector<std::uint32_t> representatives(const SemiRegularMesh& mesh,
                                                         const std::vector<std::uint32_t>& flags, std::size_t level);

}  // namespace greenloop::offline
