#include "sim_hw/body/body_surface.hpp"

#include <algorithm>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>

namespace greenloop {
namespace {

using Triangle = std::array<std::uint32_t, 3>;
using Edge = std::pair<std::uint32_t, std::uint32_t>;

Edge edge(std::uint32_t a, std::uint32_t b) { return {std::min(a, b), std::max(a, b)}; }

std::map<Edge, std::uint32_t> midpoints(const LevelView& level) {
  std::map<Edge, std::uint32_t> midpoint;
  for (std::uint32_t i = 0; i < level.counts->node_count; ++i) {
    const auto& parent = level.refinement[i].parent;
    midpoint[edge(parent[0], parent[1])] = level.node_begin + i;
  }
  return midpoint;
}

std::vector<Triangle> split(const std::vector<Triangle>& coarse, const LevelView& level, std::uint32_t number) {
  const auto midpoint = midpoints(level);
  const auto middle = [&](std::uint32_t a, std::uint32_t b) {
    const auto found = midpoint.find(edge(a, b));
    if (found == midpoint.end()) {
      throw std::runtime_error("model: Refinement(" + std::to_string(number) + ") has no node between nodes " +
                               std::to_string(a) + " and " + std::to_string(b) + "; build the model anew");
    }
    return found->second;
  };
  std::vector<Triangle> fine;
  fine.reserve(4 * coarse.size());
  for (const auto& [a, b, c] : coarse) {
    const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    fine.insert(fine.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
  }
  return fine;
}

std::vector<Triangle> finest_triangles(const ModelView& model) {
  std::vector<Triangle> triangles(model.level[0].counts->base_triangle_count);
  for (std::size_t t = 0; t < triangles.size(); ++t) std::copy_n(model.base_triangles + 3 * t, 3, triangles[t].begin());
  for (std::uint32_t q = 1; q < model.levels; ++q) triangles = split(triangles, model.level[q], q);
  return triangles;
}

void read_nodes(const ModelView& model, BodySurface& surface) {
  for (std::uint32_t q = 0; q < model.levels; ++q) {
    const LevelView& level = model.level[q];
    for (std::uint32_t i = 0; i < level.counts->node_count; ++i) {
      const layout::NodeRecord& node = level.nodes[i];
      surface.position.push_back({node.position[0], node.position[1], node.position[2]});
      surface.touchable.push_back((node.flags & layout::node_touchable) != 0);
    }
  }
}

void measure(BodySurface& surface) {
  surface.normal.assign(surface.position.size(), {});
  double edges = 0;
  for (const auto& [a, b, c] : surface.triangles) {
    const Double3 ab = surface.position[b] - surface.position[a], ac = surface.position[c] - surface.position[a];
    const Double3 area = cross(ab, ac);
    for (const std::uint32_t node : {a, b, c}) surface.normal[node] += area;
    edges += norm(ab) + norm(ac) + norm(ac - ab);
  }
  for (Double3& normal : surface.normal) normal = unit(normal);
  surface.spacing = edges / (3 * static_cast<double>(surface.triangles.size()));
}

}  // namespace

std::vector<std::uint32_t> BodySurface::touchable_nodes() const {
  std::vector<std::uint32_t> nodes;
  for (std::uint32_t i = 0; i < touchable.size(); ++i) {
    if (touchable[i]) nodes.push_back(i);
  }
  return nodes;
}

BodySurface body_surface(const ModelView& model) {
  BodySurface surface;
  read_nodes(model, surface);
  if (std::find(surface.touchable.begin(), surface.touchable.end(), true) == surface.touchable.end()) {
    throw std::runtime_error(
        "model: no node of its levels is touchable; keep more levels, or name a place in the scene's [[touched]]");
  }
  surface.triangles = finest_triangles(model);
  measure(surface);
  const float *low = model.info->box_min, *high = model.info->box_max;
  const Double3 lower{low[0], low[1], low[2]}, upper{high[0], high[1], high[2]};
  surface.centre = 0.5 * (lower + upper);
  surface.diagonal = norm(upper - lower);
  return surface;
}

}  // namespace greenloop
