#include "sim_hw/drag/soft_vertices.hpp"

#include <algorithm>

namespace greenloop {

std::vector<std::uint32_t> soft_vertices(const MultigridView& view) {
  const layout::MultigridInfo& info = *view.info;
  float softest = view.matters[0].mu;
  for (std::uint32_t m = 1; m < info.matters; ++m) softest = std::min(softest, view.matters[m].mu);
  std::vector<char> is_soft(info.vertices, 1), is_shown(info.vertices, 0);
  for (const layout::TetrahedronRecord& tetrahedron : view.tetrahedra) {
    if (view.matters[tetrahedron.matter].mu <= softest) continue;
    for (const std::uint32_t v : tetrahedron.vertex) is_soft[v] = 0;
  }
  for (const layout::BindingRecord& binding : view.bindings) {
    const auto most = std::max_element(std::begin(binding.weight), std::end(binding.weight));
    is_shown[binding.vertex[most - std::begin(binding.weight)]] = 1;
  }
  std::vector<std::uint32_t> vertices;
  for (std::uint32_t v = 0; v < info.free; ++v) {
    if (is_soft[v] != 0 && is_shown[v] != 0) vertices.push_back(v);
  }
  return vertices;
}

}  // namespace greenloop
