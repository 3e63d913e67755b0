#include "offline/report/model_surface.hpp"

#include <algorithm>
#include <cstddef>
#include <span>
#include <stdexcept>
#include <string>

#include "formats/mesh/model_surface.hpp"

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
          .fixed = with_flag(flags, mesh.vertex_end[l], layout::node_fixed),
          .touchable = touchable(l)};
}

std::vector<char> ModelSurface::touchable(int l) const {
  return with_flag(flags, mesh.vertex_end[l], layout::node_touchable);
}

ModelSurface model_surface(const ModelView& model) {
  ModelSurface surface{.mesh = semi_regular_surface(model), .flags = {}};
  for (const LevelView& level : std::span(model.level).first(model.levels)) {
    for (const layout::NodeRecord& node : std::span(level.nodes, level.counts->node_count)) {
      surface.flags.push_back(node.flags);
    }
  }
  try {
    (void)triangles_of_level(surface.mesh, surface.mesh.finest_level());
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(std::string("model file: its levels do not subdivide each other: ") + error.what());
  }
  return surface;
}

}  // namespace greenloop::offline
