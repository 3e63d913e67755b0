#include "offline/compress/encode/touchable_nodes.hpp"

namespace greenloop::offline {

std::vector<TouchableNode> touchable_nodes(const ModelView& view) {
  std::vector<TouchableNode> nodes;
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    const LevelView& level = view.level[q];
    for (std::uint32_t i = 0; i < level.counts->domain_count; ++i) {
      if ((level.nodes[i].flags & layout::node_touchable) != 0) {
        nodes.push_back({level.node_begin + i, level.domain_begin + i});
      }
    }
  }
  return nodes;
}

}  // namespace greenloop::offline
