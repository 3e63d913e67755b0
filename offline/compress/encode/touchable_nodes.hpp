#pragma once

#include <cstdint>
#include <vector>

#include "formats/view.hpp"

namespace greenloop::offline {

struct TouchableNode {
  std::uint32_t node = 0, row = 0;  ///< in the file, in the domain
};

/// The nodes of a model that can be contacts, increasing. Offline only.
[[nodiscard]] std::vector<TouchableNode> touchable_nodes(const ModelView& view);

}  // namespace greenloop::offline
