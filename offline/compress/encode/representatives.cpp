#include "offline/compress/encode/representatives.hpp"

#include <algorithm>
#include <limits>

#include "formats/layout.hpp"

namespace greenloop::offline {
namespace {

/// One hat's share in a node.
struct HatWeight {
  std::size_t vertex = 0;
  double weight = 0;
};

using Hats = std::vector<std::vector<HatWeight>>;

void accumulate(std::vector<HatWeight>& sum, const std::vector<HatWeight>& part, double factor) {
  for (const auto& [vertex, weight] : part) {
    const auto it = std::find_if(sum.begin(), sum.end(), [&, v = vertex](const auto& s) { return s.vertex == v; });
    if (it == sum.end()) {
      sum.push_back({vertex, factor * weight});
    } else {
      it->weight += factor * weight;
    }
  }
}

/// Per node the hats of K(level) that reach it: at most three, which sum to one.
Hats hats_at_nodes(const SemiRegularMesh& mesh, std::size_t level) {
  Hats hats(mesh.positions.size());
  for (std::size_t node = 0; node < hats.size(); ++node) {
    if (node < mesh.vertex_end[level]) {
      hats[node] = {{node, 1.0}};
    } else {
      for (const int parent : mesh.parents[node]) accumulate(hats[node], hats[static_cast<std::size_t>(parent)], 0.5);
    }
    std::sort(hats[node].begin(), hats[node].end(), [](const auto& a, const auto& b) { return a.vertex < b.vertex; });
  }
  return hats;
}

bool has(std::uint32_t flags, layout::NodeFlag flag) { return (flags & flag) != 0; }

std::uint32_t nearest(const SemiRegularMesh& mesh, const std::vector<std::uint32_t>& flags, std::size_t end,
                      std::size_t node) {
  std::uint32_t found = layout::none;
  double least = std::numeric_limits<double>::infinity();
  for (std::uint32_t k = 0; k < end; ++k) {
    const double distance = (mesh.positions[k] - mesh.positions[node]).squaredNorm();
    if (has(flags[k], layout::node_domain) && distance < least) {
      least = distance;
      found = k;
    }
  }
  return found;
}

}  // namespace

std::vector<std::uint32_t> representatives(const SemiRegularMesh& mesh, const std::vector<std::uint32_t>& flags,
                                           std::size_t level) {
  const Hats hats = hats_at_nodes(mesh, level);
  std::vector<std::uint32_t> result(flags.size(), layout::none);
  for (std::size_t node = 0; node < flags.size(); ++node) {
    if (!has(flags[node], layout::node_touchable) || has(flags[node], layout::node_fixed)) continue;
    const HatWeight* best = nullptr;
    for (const auto& hat : hats[node]) {
      if (has(flags[hat.vertex], layout::node_domain) && (best == nullptr || hat.weight > best->weight)) best = &hat;
    }
    result[node] =
        best != nullptr ? static_cast<std::uint32_t>(best->vertex) : nearest(mesh, flags, mesh.vertex_end[level], node);
  }
  return result;
}

}  // namespace greenloop::offline
