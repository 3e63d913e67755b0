#include "runtime/point_functional.hpp"

namespace greenloop {
namespace {

PointSupport support_at(std::uint32_t node) { return PointSupport{1, {node}, {1.0F}}; }

bool add(PointSupport& support, std::uint32_t node, float weight) {
  for (std::uint32_t i = 0; i < support.count; ++i) {
    if (support.node[i] == node) {
      support.weight[i] += weight;
      return true;
    }
  }
  if (support.count == PointSupport::most) {
    return false;
  }
  support.node[support.count] = node;
  support.weight[support.count++] = weight;
  return true;
}

bool contains(const PointSupport& support, std::uint32_t count, std::uint32_t node) {
  for (std::uint32_t i = 0; i < count; ++i) {
    if (support.node[i] == node) {
      return true;
    }
  }
  return false;
}

float lifted(const layout::RefinementRecord& odd, const PointSupport& support) {
  return odd.lift[0] * support.of(odd.parent[0]) + odd.lift[1] * support.of(odd.parent[1]);
}

// details beside the support's nodes: what prediction gave to the fine support, less what lifting takes
std::uint32_t write_neighbours(const ModelView& view, const Lifting& lifting, std::uint32_t level,
                               const PointSupport& fine, const PointSupport& support, PointCoefficient* coefficient) {
  const LevelView& at = view.level[level];
  std::uint32_t length = 0;
  for (std::uint32_t i = 0; i < support.count; ++i) {
    const std::uint32_t* record = lifting.begin[level] + domain_place(view, support.node[i]);
    for (std::uint32_t n = record[0]; n < record[1]; ++n) {
      const OddNeighbours& neighbours = lifting.neighbours[level][n];
      for (std::uint32_t k = 0; k < neighbours.count; ++k) {
        const std::uint32_t odd = neighbours.node(k);
        const layout::RefinementRecord& refinement = at.refinement[odd - at.node_begin];
        // of two parents in the support, the first writes for both
        const std::uint32_t other = refinement.parent[refinement.parent[0] == support.node[i] ? 1 : 0];
        if (!contains(support, i, other)) {
          coefficient[length++] = {odd, fine.of(odd) - lifted(refinement, support)};
        }
      }
    }
  }
  return length;
}

// odd nodes of the fine support with no parent in the domain: nobody's neighbours
std::uint32_t write_orphans(const ModelView& view, std::uint32_t level, const PointSupport& fine,
                            PointCoefficient* coefficient) {
  const LevelView& at = view.level[level];
  std::uint32_t length = 0;
  for (std::uint32_t i = 0; i < fine.count; ++i) {
    if (fine.node[i] >= at.node_begin) {
      const std::uint32_t* parent = at.refinement[fine.node[i] - at.node_begin].parent;
      if (!in_domain(view, parent[0]) && !in_domain(view, parent[1])) {
        coefficient[length++] = {fine.node[i], fine.weight[i]};
      }
    }
  }
  return length;
}

}  // namespace

float PointSupport::of(std::uint32_t wanted) const noexcept {
  float found = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    found = node[i] == wanted ? weight[i] : found;
  }
  return found;
}

bool coarsen(const ModelView& view, std::uint32_t level, PointSupport& support) noexcept {
  const LevelView& at = view.level[level];
  PointSupport coarse;
  for (std::uint32_t i = 0; i < support.count; ++i) {
    const std::uint32_t node = support.node[i];
    if (node < at.node_begin) {
      if (!add(coarse, node, support.weight[i])) {
        return false;
      }
      continue;
    }
    for (const std::uint32_t parent : at.refinement[node - at.node_begin].parent) {
      if (in_domain(view, parent) && !add(coarse, parent, 0.5F * support.weight[i])) {
        return false;
      }
    }
  }
  support = coarse;
  return true;
}

std::uint32_t point_functional(const ModelView& view, const Lifting& lifting, std::uint32_t node,
                               PointCoefficient* coefficient) noexcept {
  // the adjoint of the inverse transform: fine to coarse, prediction before lifting
  std::uint32_t length = 0;
  PointSupport support = support_at(node);
  for (std::uint32_t level = view.levels; level-- > 1;) {
    const PointSupport fine = support;
    if (!coarsen(view, level, support)) {
      return 0;
    }
    length += write_neighbours(view, lifting, level, fine, support, coefficient + length);
    length += write_orphans(view, level, fine, coefficient + length);
  }
  for (std::uint32_t i = 0; i < support.count; ++i) {
    coefficient[length++] = {support.node[i], support.weight[i]};
  }
  return length;
}

std::uint32_t point_functional_bound(const ModelView& view, const std::uint32_t* most_neighbours,
                                     std::uint32_t node) noexcept {
  PointSupport support = support_at(node);
  std::uint32_t bound = 0;
  for (std::uint32_t level = view.levels; level-- > 1;) {
    const std::uint32_t fine = support.count;
    if (!coarsen(view, level, support)) {
      return 0;
    }
    bound += fine + support.count * most_neighbours[level];
  }
  return bound + support.count;
}

}  // namespace greenloop
