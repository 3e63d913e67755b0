#pragma once

#include <cstdint>

#include "formats/view.hpp"

namespace greenloop {

/// Mesh level of a node, by its place in the file. Work: at most one unit per level.
inline std::uint32_t level_of(const ModelView& view, std::uint32_t node) noexcept {
  std::uint32_t level = 0;
  while (level + 1 < view.levels && node >= view.level[level + 1].node_begin) {
    ++level;
  }
  return level;
}

/// What the file says of a node. Work: that of level_of.
inline const layout::NodeRecord& node_record(const ModelView& view, std::uint32_t node) noexcept {
  const LevelView& level = view.level[level_of(view, node)];
  return level.nodes[node - level.node_begin];
}

/// Calls visit(node, record) for every node, in the order of the file.
template <class Visit>
void visit_nodes(const ModelView& view, Visit visit) {
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    const LevelView& level = view.level[q];
    for (std::uint32_t i = 0; i < level.counts->node_count; ++i) {
      visit(level.node_begin + i, level.nodes[i]);
    }
  }
}

/// Whether a node's displacement is stored.
inline bool in_domain(const ModelView& view, std::uint32_t node) noexcept {
  const LevelView& level = view.level[level_of(view, node)];
  return node - level.node_begin < level.counts->domain_count;
}

/// Nodes of K(level): they come first.
inline std::uint32_t nodes_up_to(const ModelView& view, std::uint32_t level) noexcept {
  return view.level[level].node_begin + view.level[level].counts->node_count;
}

/// Domain nodes of K(level).
inline std::uint32_t domain_up_to(const ModelView& view, std::uint32_t level) noexcept {
  return view.level[level].domain_begin + view.level[level].counts->domain_count;
}

/// Place of a domain node of the mesh level `level` among all domain nodes.
inline std::uint32_t domain_place(const ModelView& view, std::uint32_t level, std::uint32_t node) noexcept {
  return node - view.level[level].node_begin + view.level[level].domain_begin;
}

/// The domain node of a place among all domain nodes. Work: at most one unit per level.
inline std::uint32_t domain_node(const ModelView& view, std::uint32_t place) noexcept {
  std::uint32_t level = 0;
  while (place >= domain_up_to(view, level)) {
    ++level;
  }
  return place - view.level[level].domain_begin + view.level[level].node_begin;
}

/// Place of a domain node among all domain nodes.
inline std::uint32_t domain_place(const ModelView& view, std::uint32_t node) noexcept {
  return domain_place(view, level_of(view, node), node);
}

}  // namespace greenloop
