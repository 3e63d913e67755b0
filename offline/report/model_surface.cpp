#include "offline/report/model_surface.hpp"

#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <string>

namespace greenloop::offline {
namespace {

std::vector<char> with_flag(const std::vector<std::uint32_t>& flags, std::size_t count, layout::NodeFlag flag) {
  std::vector<char> has(count);
  std::transform(flags.begin(), flags.begin() + static_cast<std::ptrdiff_t>(count), has.begin(),
                 [flag](std::uint32_t bits) { return static_cast<char>((bits & flag) != 0); });
  return has;
}

}  // namespace

std::size_t ModelSurface::count(layout::NodeFlag flag) const {
  return static_cast<std::size_t>(
      std::count_if(flags.begin(), flags.end(), [flag](std::uint32_t bits) { return (bits & flag) != 0; }));
}

VisibleSurface ModelSurface::level(int l) const {
  const auto end = static_cast<std::ptrdiff_t>(mesh.vertex_end[l]);
  return {.positions = {mesh.positions.begin(), mesh.positions.begin() + end},
          .triangles = triangles_of_level(mesh, l),
          .fixed = with_flag(flags, mesh.vertex_end[l], layout::node_fixed)};
}

std::vector<char> ModelSurface::touchable(int l) const {
  return with_flag(flags, mesh.vertex_end[l], layout::node_touchable);
}

ModelSurface model_surface(const ModelView& model) {
  ModelSurface surface;
  for (std::uint32_t q = 0; q < model.levels; ++q) {
    const LevelView& level = model.level[q];
    for (std::uint32_t i = 0; i < level.counts->node_count; ++i) {
      const layout::NodeRecord& node = level.nodes[i];
      surface.mesh.positions.emplace_back(node.position[0], node.position[1], node.position[2]);
      surface.flags.push_back(node.flags);
      std::array<int, 2> parents{-1, -1};
      if (q > 0) {
        const auto& [a, b] = level.refinement[i].parent;
        parents = {static_cast<int>(std::min(a, b)), static_cast<int>(std::max(a, b))};
      }
      surface.mesh.parents.push_back(parents);
    }
    surface.mesh.vertex_end.push_back(surface.mesh.positions.size());
  }
  for (std::uint32_t t = 0; t < model.level[0].counts->base_triangle_count; ++t) {
    const std::uint32_t* corner = model.base_triangles + 3 * static_cast<std::size_t>(t);
    surface.mesh.base_triangles.push_back(
        {static_cast<int>(corner[0]), static_cast<int>(corner[1]), static_cast<int>(corner[2])});
  }
  try {
    (void)triangles_of_level(surface.mesh, surface.mesh.finest_level());
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(std::string("model file: its levels do not subdivide each other: ") + error.what());
  }
  return surface;
}

}  // namespace greenloop::offline
