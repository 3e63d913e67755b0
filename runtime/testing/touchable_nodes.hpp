#pragma once

#include <cstdint>
#include <vector>

#include "runtime/wavelet/domain.hpp"

namespace greenloop {

/// Calls visit(node, record) for every node that may be a contact, in the order of the file.
template <class Visit>
void visit_touchable(const ModelView& view, Visit visit) {
  visit_nodes(view, [&visit](std::uint32_t node, const layout::NodeRecord& record) {
    if ((record.flags & layout::node_touchable) != 0) visit(node, record);
  });
}

/// File indices of those, increasing.
[[nodiscard]] inline std::vector<std::uint32_t> touchable_nodes(const ModelView& view) {
  std::vector<std::uint32_t> nodes;
  visit_touchable(view, [&nodes](std::uint32_t node, const layout::NodeRecord&) { nodes.push_back(node); });
  return nodes;
}

}  // namespace greenloop
