#include "runtime/surface.hpp"

#include <cmath>
#include <cstring>
#include <new>

#include "runtime/memory/arena.hpp"
#include "runtime/memory/fit.hpp"
#include "runtime/surface/closest_point.hpp"
#include "runtime/surface/parts.hpp"
#include "runtime/surface/shape.hpp"
#include "runtime/surface/subdivision.hpp"

namespace greenloop {
namespace {

constexpr std::uint64_t most_triangles = std::uint64_t{1} << 30;

SurfaceParts* carve(Arena& arena, const ModelView& view, std::uint32_t level, Subdivision& subdivision) {
  auto* memory = arena.take<SurfaceParts>(1);
  SurfaceParts counted;
  SurfaceParts& parts = memory == nullptr ? counted : *new (memory) SurfaceParts;
  parts.level = level;
  parts.base_triangles = view.level[0].counts->base_triangle_count;
  for (std::uint32_t q = 0; q <= level; ++q) {
    parts.node_count[q] = view.level[q].node_begin + view.level[q].counts->node_count;
  }
  const auto triangles = static_cast<std::uint32_t>(subdivided_count(view, level));
  parts.nodes = arena.take<layout::NodeRecord>(parts.node_count[level]);
  parts.triangles = arena.take<Surface::Triangle>(triangles);
  parts.tree.carve(arena, triangles);
  subdivision.carve(arena, view, level);
  return memory;
}

bool fill(const ModelView& view, Subdivision& subdivision, SurfaceParts& parts) {
  for (std::uint32_t q = 0; q <= parts.level; ++q) {
    const LevelView& level = view.level[q];
    std::memcpy(parts.nodes + level.node_begin, level.nodes, sizeof *level.nodes * level.counts->node_count);
  }
  if (!subdivision.fill(view, parts.level, parts.triangles)) return false;
  parts.tree.build(parts.nodes, parts.triangles);
  return true;
}

Surface::Error check(const ModelView& view, std::uint32_t level) {
  if (level >= view.levels) return Surface::Error::bad_level;
  return subdivided_count(view, level) < most_triangles ? Surface::Error::none : Surface::Error::unsupported_model;
}

std::uint64_t bytes_of(const ModelView& view, std::uint32_t level) {
  Arena counting;
  Subdivision subdivision;
  carve(counting, view, level, subdivision);
  return counting.bytes();
}

bool is_finite(const Vec3& position) {
  return std::isfinite(position.x) && std::isfinite(position.y) && std::isfinite(position.z);
}

Double3 exact(const Vec3& position) { return {position.x, position.y, position.z}; }

Double3 place(const layout::NodeRecord& node) { return {node.position[0], node.position[1], node.position[2]}; }

// whether (distance, index) comes before that of the best; distances that are equal go by index
template <class Best>
bool is_better(double squared_distance, std::uint32_t index, const Best& best, std::uint32_t best_index) {
  return best_index == layout::none || squared_distance < best.squared_distance ||
         (squared_distance == best.squared_distance && index < best_index);
}

}  // namespace

Surface::Requirement Surface::required(const Model& model, std::uint32_t level) noexcept {
  const ModelView& view = model.view();
  if (check(view, level) != Error::none) return {};
  const std::uint64_t bytes = bytes_of(view, level);
  return {bytes <= SIZE_MAX ? static_cast<std::size_t>(bytes) : 0};
}

Surface::Created Surface::create(const Model& model, std::uint32_t level, std::span<std::byte> memory) noexcept {
  const ModelView& view = model.view();
  Created created;
  created.available = memory.size();
  created.error = check(view, level);
  if (!created) return created;
  created.requested = required(model, level).bytes;
  if (created.requested == 0) {
    created.error = Error::unsupported_model;
    return created;
  }
  if (!memory_fits(memory, Error::memory_too_small, Error::memory_misaligned, created)) return created;
  Arena arena(memory.data());
  Subdivision subdivision;
  SurfaceParts* const parts = carve(arena, view, level, subdivision);
  if (!fill(view, subdivision, *parts)) {
    created.error = Error::unsupported_model;
    return created;
  }
  created.surface.parts_ = parts;
  return created;
}

std::uint32_t Surface::level() const noexcept { return parts_->level; }

std::uint32_t Surface::node_count(std::uint32_t level) const noexcept {
  return level <= parts_->level ? parts_->node_count[level] : 0;
}

std::uint32_t Surface::triangle_count(std::uint32_t level) const noexcept {
  return level <= parts_->level ? parts_->base_triangles << (2 * level) : 0;
}

Surface::Triangle Surface::triangle(std::uint32_t level, std::uint32_t t) const noexcept {
  return triangle_of_level(*parts_, level, t);
}

bool Surface::triangles(std::uint32_t level, std::span<Triangle> triangle) const noexcept {
  if (level > parts_->level || triangle.size() != triangle_count(level)) return false;
  for (std::uint32_t t = 0; t < triangle.size(); ++t) triangle[t] = triangle_of_level(*parts_, level, t);
  return true;
}

bool Surface::normals(std::uint32_t level, std::span<const Vec4> displacement, std::span<Vec4> normal) const noexcept {
  if (!fits(level, displacement, normal.size())) return false;
  write_normals(*parts_, level, displacement, normal);
  return true;
}

bool Surface::areas(std::uint32_t level, std::span<const Vec4> displacement, std::span<float> area) const noexcept {
  if (!fits(level, displacement, area.size())) return false;
  write_areas(*parts_, level, displacement, area);
  return true;
}

bool Surface::fits(std::uint32_t level, std::span<const Vec4> displacement, std::size_t written) const noexcept {
  return level <= parts_->level && written == node_count(level) &&
         (displacement.empty() || displacement.size() >= written);
}

Surface::NearestNode Surface::nearest_node(Vec3 position, std::uint32_t flags) const noexcept {
  NearestNode best;
  if (!is_finite(position)) return best;
  const Double3 from = exact(position);
  parts_->tree.visit(from, [&](std::uint32_t t, Reach& reach) {
    for (const std::uint32_t node : parts_->triangles[t].node) {
      const Double3 offset = place(parts_->nodes[node]) - from;
      const double distance = dot(offset, offset);
      if ((parts_->nodes[node].flags & flags) == flags && is_better(distance, node, best, best.node)) {
        best = {node, distance};
        reach.shrink(distance);
      }
    }
  });
  return best;
}

Surface::NearestPoint Surface::nearest_point(Vec3 position) const noexcept {
  NearestPoint best;
  if (!is_finite(position)) return best;
  const Double3 from = exact(position);
  parts_->tree.visit(from, [&](std::uint32_t t, Reach& reach) {
    const auto& [a, b, c] = parts_->triangles[t].node;
    const layout::NodeRecord* const nodes = parts_->nodes;
    const ClosestPoint point =
        closest_to_origin({place(nodes[a]) - from, place(nodes[b]) - from, place(nodes[c]) - from});
    if (is_better(point.squared_distance, t, best, best.triangle)) {
      const double* w = point.weight;
      best = {
          t, {static_cast<float>(w[0]), static_cast<float>(w[1]), static_cast<float>(w[2])}, point.squared_distance};
      reach.shrink(point.squared_distance);
    }
  });
  return best;
}

}  // namespace greenloop
