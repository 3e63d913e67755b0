#include "sim_hw/body/body_surface.hpp"

#include <algorithm>
#include <stdexcept>

#include "formats/write/aligned_bytes.hpp"
#include "runtime/wavelet/domain.hpp"

namespace greenloop {
namespace {

std::vector<Surface::Triangle> finest_triangles(const Model& model) {
  const std::uint32_t finest = model.level_count() - 1;
  AlignedBytes memory(Surface::required(model, finest).bytes);
  const auto created = Surface::create(model, finest, {memory.data(), memory.size()});
  if (!created) {
    throw std::runtime_error("model: its refinement is not that of a subdivided triangulation; build the model anew");
  }
  std::vector<Surface::Triangle> triangles(created.surface.triangle_count(finest));
  (void)created.surface.triangles(finest, triangles);
  return triangles;
}

void read_nodes(const ModelView& model, BodySurface& surface) {
  visit_nodes(model, [&surface](std::uint32_t, const layout::NodeRecord& node) {
    surface.position.push_back({node.position[0], node.position[1], node.position[2]});
    surface.touchable.push_back((node.flags & layout::node_touchable) != 0);
  });
}

void measure(BodySurface& surface) {
  surface.normal.assign(surface.position.size(), {});
  double edges = 0;
  for (const Surface::Triangle& triangle : surface.triangles) {
    const auto& [a, b, c] = triangle.node;
    const Double3 ab = surface.position[b] - surface.position[a], ac = surface.position[c] - surface.position[a];
    const Double3 area = cross(ab, ac);
    for (const std::uint32_t node : triangle.node) surface.normal[node] += area;
    edges += norm(ab) + norm(ac) + norm(ac - ab);
  }
  for (Double3& normal : surface.normal) normal = unit(normal);
  surface.spacing = edges / (3 * static_cast<double>(surface.triangles.size()));
}

}  // namespace

BodySurface body_surface(const Model& model) {
  BodySurface surface;
  read_nodes(model.view(), surface);
  if (std::find(surface.touchable.begin(), surface.touchable.end(), true) == surface.touchable.end()) {
    throw std::runtime_error(
        "model: no node of its levels is touchable; keep more levels, or name a place in the scene's [[touched]]");
  }
  surface.triangles = finest_triangles(model);
  measure(surface);
  const float *low = model.view().info->box_min, *high = model.view().info->box_max;
  const Double3 lower{low[0], low[1], low[2]}, upper{high[0], high[1], high[2]};
  surface.centre = 0.5 * (lower + upper);
  surface.diagonal = norm(upper - lower);
  return surface;
}

}  // namespace greenloop
