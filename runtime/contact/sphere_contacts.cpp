#include "runtime/contact/sphere_contacts.hpp"

#include <algorithm>
#include <cfloat>
#include <cmath>

#include "runtime/algebra/merge_sort.hpp"

namespace greenloop {
namespace {

constexpr double least_facing = 0.2;  // cosine between the surface's inward normal and the axis
constexpr double margin = 1e-3;       // of the radius: nearer to the sphere's surface is touching, not inside

bool good(const SurfaceNodes& nodes, const SphereContacts::Limits& limits) {
  return limits.radius > 0 && limits.radius <= DBL_MAX && limits.max_contacts > 0 && !nodes.touchable.empty() &&
         nodes.normal.size() == nodes.position.size() && nodes.touchable.back() < nodes.position.size();
}

}  // namespace

void SphereContacts::carve(Arena& arena) noexcept {
  grid_.carve(arena, nodes_.position, nodes_.touchable, limits_.radius);
  node_ = arena.take_zeroed<Node>(nodes_.position.size());
  held_ = arena.take<std::uint32_t>(nodes_.touchable.size());
  spare_ = arena.take<std::uint32_t>(nodes_.touchable.size());
  contact_ = arena.take_zeroed<Constraint>(limits_.max_contacts);
}

std::size_t SphereContacts::required(const SurfaceNodes& nodes, const Limits& limits) noexcept {
  if (!good(nodes, limits)) return 0;
  SphereContacts counted;
  counted.nodes_ = nodes;
  counted.limits_ = limits;
  Arena arena;
  counted.carve(arena);
  return static_cast<std::size_t>(arena.bytes());
}

SphereContacts::Created SphereContacts::create(const SurfaceNodes& nodes, const Limits& limits,
                                               std::span<std::byte> memory) noexcept {
  Created created;
  created.requested = required(nodes, limits);
  created.available = memory.size();
  if (created.requested == 0) {
    created.error = CreateError::bad_limits;
  } else if (created.requested > memory.size()) {
    created.error = CreateError::arena_too_small;
    created.missing = created.requested - memory.size();
  } else if (reinterpret_cast<std::uintptr_t>(memory.data()) % Arena::alignment != 0) {
    created.error = CreateError::arena_misaligned;
  }
  if (!created) return created;
  SphereContacts& made = created.contacts;
  made.nodes_ = nodes;
  made.limits_ = limits;
  Arena arena(memory.data());
  made.carve(arena);
  made.grid_.fill(nodes.position, nodes.touchable);
  return created;
}

std::span<const Constraint> SphereContacts::find(std::span<const SphereTool> tools,
                                                 std::span<const float> field) noexcept {
  while (count_ > 0) node_[held_[--count_]].held_by = 0;
  const std::size_t heeded = std::min<std::size_t>(tools.size(), max_tools);
  for (std::size_t t = 0; t < heeded; ++t) gather(tools[t], static_cast<std::uint8_t>(t + 1), field);
  keep_deepest();
  for (std::uint32_t i = 0; i < count_; ++i) {
    const Double3 moved = node_[held_[i]].depth * tools[holder(i)].axis;
    contact_[i] = {held_[i], {static_cast<float>(moved.x), static_cast<float>(moved.y), static_cast<float>(moved.z)}};
  }
  return {contact_, count_};
}

void SphereContacts::gather(const SphereTool& tool, std::uint8_t held_by, std::span<const float> field) noexcept {
  const double radius = limits_.radius, touching = radius * (1 - margin);
  grid_.near(tool.centre, radius, [&](std::uint32_t at) {
    Node& node = node_[at];
    const Double3 offset = nodes_.position[at] - tool.centre;
    const double outside = dot(offset, offset) - radius * radius;
    if (!(outside < 0) || !(-dot(nodes_.normal[at], tool.axis) >= least_facing)) return;
    if (node.pushed != push_of(held_by)) {
      const float* moved = &field[std::size_t{4} * at];
      const Double3 now = offset + Double3{moved[0], moved[1], moved[2]};
      if (!(dot(now, now) < touching * touching)) return;
    }
    const double along = dot(offset, tool.axis), depth = std::sqrt(along * along - outside) - along;
    if (!(depth <= DBL_MAX) || (node.held_by != 0 && depth <= node.depth)) return;
    if (node.held_by == 0) held_[count_++] = at;
    node.held_by = held_by;
    node.depth = depth;
  });
}

void SphereContacts::keep_deepest() noexcept {
  const auto drop_last = [this] { node_[held_[--count_]].held_by = 0; };
  for (bool by_depth = count_ > limits_.max_contacts;; by_depth = false) {
    merge_sort(count_, held_, spare_, [this, by_depth](std::uint32_t a, std::uint32_t b) {
      const double difference = by_depth ? node_[a].depth - node_[b].depth : 0;
      return difference != 0 ? difference > 0 : a < b;
    });
    if (!by_depth) return;
    while (count_ > limits_.max_contacts) drop_last();
  }
}

void SphereContacts::settle(std::span<const SphereTool> tools, std::span<const float> force) noexcept {
  ++settled_;
  for (std::uint32_t i = 0; i < count_; ++i) {
    const float* f = &force[std::size_t{3} * i];
    Node& node = node_[held_[i]];
    if (dot(Double3{f[0], f[1], f[2]}, tools[holder(i)].axis) >= 0) node.pushed = push_of(node.held_by);
  }
}

}  // namespace greenloop
