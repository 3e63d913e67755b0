#include "runtime/support.hpp"

#include "runtime/domain.hpp"
#include "runtime/wavelet.hpp"

namespace greenloop {
namespace {

bool add(PointSupport& support, std::uint32_t node) {
  for (std::uint32_t i = 0; i < support.count; ++i) {
    if (support.node[i] == node) {
      return true;
    }
  }
  if (support.count == PointSupport::most) {
    return false;
  }
  support.node[support.count++] = node;
  return true;
}

void raise(std::uint32_t& bound, std::uint32_t value) { bound = value > bound ? value : bound; }

// nodes of M(level) in the support with no domain parent: nobody's neighbours
std::uint32_t orphans(const ModelView& view, std::uint32_t level, const PointSupport& support) {
  const LevelView& at = view.level[level];
  std::uint32_t count = 0;
  for (std::uint32_t i = 0; i < support.count; ++i) {
    if (support.node[i] >= at.node_begin) {
      const std::uint32_t* parent = at.refinement[support.node[i] - at.node_begin].parent;
      count += in_domain(view, parent[0]) || in_domain(view, parent[1]) ? 0 : 1;
    }
  }
  return count;
}

// forced: nodes of each level's mesh that a force on the node is shared among
bool follow(const ModelView& view, std::uint32_t c, std::uint32_t node, const std::uint32_t* most_neighbours,
            std::uint32_t* forced, ReachBound& bound) {
  PointSupport support{1, {node}};
  for (std::uint32_t level = c; level > 0; --level) {
    const std::uint32_t alone = orphans(view, level, support);
    if (!coarsen(view, level, support)) {
      return false;
    }
    raise(bound.coefficients[level], support.count * most_neighbours[level] + alone);
    raise(forced[level - 1], support.count);
  }
  return true;
}

}  // namespace

bool coarsen(const ModelView& view, std::uint32_t level, PointSupport& support) noexcept {
  const LevelView& at = view.level[level];
  PointSupport coarse;
  for (std::uint32_t i = 0; i < support.count; ++i) {
    const std::uint32_t node = support.node[i];
    if (node < at.node_begin) {
      if (!add(coarse, node)) {
        return false;
      }
      continue;
    }
    for (const std::uint32_t parent : at.refinement[node - at.node_begin].parent) {
      if (in_domain(view, parent) && !add(coarse, parent)) {
        return false;
      }
    }
  }
  support = coarse;
  return true;
}

ReachBound bound_reach(const ModelView& view, std::uint32_t c, const std::uint32_t* most_neighbours) noexcept {
  ReachBound bound;
  std::uint32_t forced[layout::max_levels] = {};
  forced[c] = 1;
  for (std::uint32_t q = 0; q <= c; ++q) {
    for (std::uint32_t i = 0; i < view.level[q].counts->domain_count; ++i) {
      if (!follow(view, c, view.level[q].node_begin + i, most_neighbours, forced, bound)) {
        return bound;
      }
    }
  }
  bound.coefficients[0] = forced[0];
  // the node, two parents of each force, all odd neighbours of each support
  bound.visits = 1;
  for (std::uint32_t level = c; level > 0; --level) {
    constexpr std::uint32_t slots = OddNeighbours::most;
    bound.visits += std::uint64_t{2} * forced[level];
    bound.visits += std::uint64_t{forced[level - 1]} * slots * ((most_neighbours[level] + slots - 1) / slots);
  }
  bound.bounded = true;
  return bound;
}

}  // namespace greenloop
