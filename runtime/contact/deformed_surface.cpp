#include "runtime/contact/deformed_surface.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "runtime/algebra/float4.hpp"
#include "runtime/memory/fit.hpp"
#include "runtime/surface/closest_point.hpp"

namespace greenloop {
namespace {

// more than the rounding of a sum of two floats, relative to the larger
constexpr float rounding = 0x1p-22F;

Float4 smaller(Float4 a, Float4 b) { return a < b ? a : b; }
Float4 larger(Float4 a, Float4 b) { return a > b ? a : b; }

Float4 load(const void* four) {
  Float4 value;
  std::memcpy(&value, four, sizeof value);
  return value;
}

void unite(const TriangleBox& a, const TriangleBox& b, TriangleBox& both) {
  for (int axis = 0; axis < 3; ++axis) {
    both.low[axis] = std::min(a.low[axis], b.low[axis]);
    both.high[axis] = std::max(a.high[axis], b.high[axis]);
  }
}

double extent_of(const TriangleBox& box) {
  double sum = 0;
  for (int axis = 0; axis < 3; ++axis) {
    sum += std::max(std::abs(double{box.low[axis]}), std::abs(double{box.high[axis]}));
  }
  return sum;
}

// what the surface of a level will have, but no arrays
SurfaceParts counted_parts(const ModelView& view, std::uint32_t level) {
  SurfaceParts parts;
  parts.level = level;
  parts.base_triangles = view.level[0].counts->base_triangle_count;
  parts.node_count[level] = view.level[level].node_begin + view.level[level].counts->node_count;
  Arena counting;
  parts.tree.carve(counting, parts.base_triangles << (2 * level));
  return parts;
}

// triangles, at every level: nodes that halve an edge have no more than six
std::uint64_t most_around_node(const ModelView& view) {
  constexpr std::uint32_t batch = 256;
  const std::uint32_t corners = 3 * view.level[0].counts->base_triangle_count;
  const std::uint32_t nodes = view.level[0].node_begin + view.level[0].counts->node_count;
  std::uint32_t most = 6;
  for (std::uint32_t first = 0; first < nodes; first += batch) {
    std::uint32_t count[batch] = {};
    for (std::uint32_t k = 0; k < corners; ++k) {
      const std::uint32_t place = view.base_triangles[k] - first;
      if (place < batch) most = std::max(most, ++count[place]);
    }
  }
  return most;
}

// Between unit vectors, to 1e-13: with its tangent halved three times the series of the arc tangent needs few terms,
// and none of it is left to a library.
double angle_between(const Double3& a, const Double3& b) {
  const double across = norm(a - b), along = norm(a + b);
  if (!(across > 0)) return 0;
  // tan(angle / 4), finite also where along is 0
  double t = across / (along + std::sqrt(along * along + across * across));
  for (int halving = 0; halving < 2; ++halving) t = t / (1 + std::sqrt(1 + t * t));
  double series = 0;
  for (int k = 17; k >= 1; k -= 2) series = 1.0 / k - t * t * series;
  return 16 * t * series;
}

}  // namespace

void DeformedSurface::carve(Arena& arena, const SurfaceParts& parts) noexcept {
  parts_ = &parts;
  const std::uint32_t patches = patch_count(parts);
  const std::uint64_t corners = 3 * std::uint64_t{triangle_count()};
  first_patch_ = patches - 1;
  boxes_ = arena.take<TriangleBox>(box_count());
  nodes_ = arena.take<Nodes>(patches);
  node_ = arena.take<std::uint32_t>(corners);
  around_end_ = arena.take_zeroed<std::uint32_t>(node_count());
  around_ = arena.take<std::uint32_t>(corners);
}

std::uint32_t DeformedSurface::patch_count(const SurfaceParts& parts) noexcept {
  const std::uint32_t depth = parts.tree.depth();
  return std::uint32_t{1} << (depth > halvings_within ? depth - halvings_within : 0);
}

std::size_t DeformedSurface::required(const Surface& surface) noexcept { return bytes_of(surface.parts()); }

std::size_t DeformedSurface::required(const Model& model, std::uint32_t level) noexcept {
  return level < model.level_count() ? bytes_of(counted_parts(model.view(), level)) : 0;
}

SurfaceSizes DeformedSurface::sizes(const Model& model, std::uint32_t level) noexcept {
  const SurfaceParts parts = counted_parts(model.view(), level);
  return {std::uint64_t{parts.base_triangles} << (2 * level), patch_count(parts), most_around_node(model.view())};
}

std::size_t DeformedSurface::bytes_of(const SurfaceParts& parts) noexcept {
  Arena arena;
  DeformedSurface counted;
  counted.carve(arena, parts);
  const bool* const is_owned = arena.take<bool>(counted.node_count());
  return is_owned == nullptr ? static_cast<std::size_t>(arena.bytes()) : 0;
}

DeformedSurface::Created DeformedSurface::create(const Surface& surface, std::span<std::byte> memory) noexcept {
  Created created;
  created.requested = required(surface);
  created.available = memory.size();
  if (!memory_fits(memory, Surface::Error::memory_too_small, Surface::Error::memory_misaligned, created))
    return created;
  Arena arena(memory.data());
  created.surface.carve(arena, surface.parts());
  created.surface.list_nodes(arena.take_zeroed<bool>(created.surface.node_count()));
  created.surface.list_surroundings();
  std::uint64_t work = 0;
  created.surface.update({}, work);
  return created;
}

void DeformedSurface::list_nodes(bool* is_owned) noexcept {
  std::uint32_t count = 0;
  for (std::uint32_t patch = first_patch_; patch < box_count(); ++patch) {
    std::uint32_t some[3 * most_in_patch];
    std::uint32_t* last = some;
    for (const std::uint32_t t : triangles_of(patch)) last = std::copy_n(triangle(t).node, 3, last);
    std::sort(some, last);
    last = std::unique(some, last);
    Nodes& nodes = nodes_[patch - first_patch_];
    nodes.begin = count;
    for (const std::uint32_t* node = some; node < last; ++node) {
      if (!is_owned[*node]) node_[count++] = *node;
    }
    nodes.own_end = count;
    for (const std::uint32_t* node = some; node < last; ++node) {
      if (is_owned[*node]) node_[count++] = *node;
    }
    nodes.end = count;
    for (const std::uint32_t* node = some; node < last; ++node) is_owned[*node] = true;
  }
}

// counting sort by node
void DeformedSurface::list_surroundings() noexcept {
  const auto visit_corners = [this](auto visit) {
    for (std::uint32_t t = 0; t < triangle_count(); ++t) {
      for (const std::uint32_t node : triangle(t).node) visit(t, node);
    }
  };
  visit_corners(
      [this](std::uint32_t, std::uint32_t node) { most_around_ = std::max(most_around_, ++around_end_[node]); });
  std::uint32_t begin = 0;
  for (std::uint32_t node = 0; node < node_count(); ++node) {
    const std::uint32_t count = around_end_[node];
    around_end_[node] = begin;
    begin += count;
  }
  visit_corners([this](std::uint32_t t, std::uint32_t node) { around_[around_end_[node]++] = t; });
}

TriangleBox DeformedSurface::box_of(const Nodes& nodes) const noexcept {
  Float4 low = splat(HUGE_VALF), high = splat(-HUGE_VALF);
  for (std::uint32_t i = nodes.begin; i < nodes.end; ++i) {
    Float4 place = load(&parts_->nodes[node_[i]].position);
    if (displacement_ != nullptr) place += load(displacement_ + node_[i]);
    low = smaller(place, low);
    high = larger(place, high);
  }
  const Float4 slack = rounding * larger(larger(low, -low), larger(high, -high));
  low -= slack;
  high += slack;
  TriangleBox box;
  std::memcpy(box.low, &low, sizeof box.low);
  std::memcpy(box.high, &high, sizeof box.high);
  return box;
}

bool DeformedSurface::update(std::span<const Vec4> displacement, std::uint64_t& work) noexcept {
  if (!displacement.empty() && displacement.size() < node_count()) return false;
  displacement_ = displacement.data();
  for (std::uint32_t patch = 0; patch <= first_patch_; ++patch) boxes_[first_patch_ + patch] = box_of(nodes_[patch]);
  for (std::uint32_t box = first_patch_; box-- > 0;) unite(boxes_[2 * box + 1], boxes_[2 * box + 2], boxes_[box]);
  extent_ = extent_of(boxes_[0]);
  work += update_work();
  return true;
}

Double3 DeformedSurface::position(const TrianglePoint& point) const noexcept {
  const auto& [a, b, c] = triangle(point.triangle).node;
  return point.weight[0] * position(a) + point.weight[1] * position(b) + point.weight[2] * position(c);
}

Double3 DeformedSurface::triangle_normal(std::uint32_t t) const noexcept {
  const auto& [a, b, c] = triangle(t).node;
  const Double3 at = position(a);
  return unit(cross(position(b) - at, position(c) - at));
}

Double3 DeformedSurface::node_normal(std::uint32_t node, std::uint64_t& work) const noexcept {
  Double3 sum;
  const std::uint32_t begin = node == 0 ? 0 : around_end_[node - 1], end = around_end_[node];
  for (std::uint32_t i = begin; i < end; ++i) {
    const auto& [a, b, c] = triangle(around_[i]).node;
    const Double3 at = position(a);
    sum += cross(position(b) - at, position(c) - at);
  }
  work += SurfacePrices::query + (end - begin) * SurfacePrices::triangle;
  return unit(sum);
}

Double3 DeformedSurface::normal(const TrianglePoint& point, std::uint64_t& work) const noexcept {
  const Double3 at = position(point);
  const bool is_corner = (point.weight[0] > 0) + (point.weight[1] > 0) + (point.weight[2] > 0) == 1;
  Double3 sum;
  visit_around(point, [&](std::uint32_t t) {
    work += SurfacePrices::triangle;
    if (!is_corner) {
      sum += triangle_normal(t);
      return;
    }
    Double3 side[2];
    int sides = 0;
    for (const std::uint32_t node : triangle(t).node) {
      const Double3 along = position(node) - at;
      if (sides < 2 && dot(along, along) > 0) side[sides++] = unit(along);
    }
    sum += angle_between(side[0], side[1]) * triangle_normal(t);
  });
  work += SurfacePrices::query + around_work();
  return unit(sum);
}

bool DeformedSurface::is_near(const Double3& position, double margin) const noexcept {
  return squared_distance(boxes_[0], position) <= margin * margin;
}

ClosestSurfacePoint DeformedSurface::closest_in(std::uint32_t t, const Double3& from) const noexcept {
  const auto& [a, b, c] = triangle(t).node;
  const ClosestPoint point = closest_to_origin({position(a) - from, position(b) - from, position(c) - from});
  return {{t, {point.weight[0], point.weight[1], point.weight[2]}}, point.squared_distance};
}

ClosestSurfacePoint DeformedSurface::closest(const Double3& from, std::uint32_t guess, std::uint64_t& work,
                                             std::uint64_t most) const noexcept {
  Reach reach(from, extent_);
  ClosestSurfacePoint best;
  const auto look = [&](std::uint32_t t) {
    work += SurfacePrices::triangle;
    const ClosestSurfacePoint found = closest_in(t, from);
    if (best.point.triangle == layout::none || found.squared_distance < best.squared_distance ||
        (found.squared_distance == best.squared_distance && t < best.point.triangle)) {
      best = found;
      reach.shrink(found.squared_distance);
    }
  };
  work += SurfacePrices::query;
  if (guess < triangle_count()) look(guess);
  const auto within = [&](double squared_distance) {
    if (work > most) return false;
    work += SurfacePrices::box;
    return reach.covers(squared_distance);
  };
  visit_nearest(boxes_, first_patch_, from, within, [&](std::uint32_t patch) {
    for (const std::uint32_t t : triangles_of(patch)) look(t);
  });
  return best;
}

}  // namespace greenloop
