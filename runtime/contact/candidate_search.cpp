#include "runtime/contact/candidate_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>

#include "runtime/algebra/merge_sort.hpp"
#include "runtime/contact/approach.hpp"
#include "runtime/memory/fit.hpp"

namespace greenloop {
namespace {

// cosine between the normals of surface and tool: what faces away by more is behind the part that the tool meets
constexpr double most_away = 0.2;

constexpr std::uint64_t tool_price = 300, box_price = 130, node_price = 130, take_price = 200, list_price = 80,
                        compare_price = 15;

bool is_good(const CandidateSearch::Limits& limits) {
  return limits.max_tools > 0 && limits.max_tools <= 254 && limits.max_points <= Shape::max_points &&
         limits.max_candidates > 0 && limits.max_candidates < layout::none && limits.margin >= 0 &&
         limits.margin <= 1e6;
}

ToolFault fault_of(PoseError error) {
  switch (error) {
    case PoseError::not_finite:
      return ToolFault::not_finite;
    case PoseError::too_far:
      return ToolFault::too_far;
    case PoseError::not_unit:
      return ToolFault::not_unit;
    case PoseError::none:
      break;
  }
  return ToolFault::none;
}

// the order in which candidates are listed
bool comes_before(const Candidate& a, const Candidate& b) {
  if (a.tool != b.tool) return a.tool < b.tool;
  const bool is_node_a = a.triangle == layout::none, is_node_b = b.triangle == layout::none;
  if (is_node_a != is_node_b) return is_node_a;
  return is_node_a ? a.node[0] < b.node[0] : a.feature < b.feature;
}

bool is_deeper(const Candidate& a, const Candidate& b) {
  return a.depth != b.depth ? a.depth > b.depth : comes_before(a, b);
}

// of room for so many, and listing those that there are
std::uint64_t list_work(std::uint64_t room, std::uint64_t count) {
  return room + list_price * count + compare_price * merge_sort_steps(count);
}

// of a candidate that is found, and of the heap if there are too many
std::uint64_t take_work(std::uint64_t room) {
  std::uint64_t halvings = 1;
  while (room >> halvings > 0) ++halvings;
  return take_price + 2 * compare_price * halvings;
}

std::uint64_t less(std::uint64_t a, std::uint64_t b) { return a > b ? a - b : 0; }

// a tool's share of the work, by its points; of one that is left out little
std::uint64_t weight_of(const Shape& shape, std::uint32_t most_points) {
  const std::uint32_t points = shape.check() == Shape::Error::none ? shape.point_count() : 0;
  return 1 + (points <= most_points ? points : 0);
}

// of the places beside the nearest one of a tool's point
std::uint64_t beside_work(const SurfaceSizes& surface, std::uint64_t room) {
  return 3 * surface.surround_work() + (CandidateSearch::most_places - 1) * take_work(room);
}

// of a tool's point: so that one that moves a little is not left out
std::uint64_t least_point_work(const SurfaceSizes& surface, std::uint64_t room) {
  return Proxy::reserve(surface) + 2 * DeformedSurface::patch_work + take_work(room);
}

// of a node that is a candidate, at most
std::uint64_t most_node_work(const DeformedSurface& surface, const Shape& shape, std::uint64_t room) {
  return node_price + shape.distance_work() + approach_work(shape) + surface.surround_work() + take_work(room);
}

template <class T>
void start_all(T* some, std::uint64_t count) {
  for (std::uint64_t i = 0; some != nullptr && i < count; ++i) new (some + i) T;
}

}  // namespace

void CandidateSearch::carve(Arena& arena) noexcept {
  const std::uint64_t proxies = std::uint64_t{limits_.max_tools} * limits_.max_points;
  tool_ = arena.take<ToolState>(limits_.max_tools);
  proxy_ = arena.take<Proxy>(proxies);
  candidate_ = arena.take<Candidate>(limits_.max_candidates + std::uint64_t{1});
  listed_ = arena.take<Candidate>(limits_.max_candidates);
  order_ = arena.take<std::uint32_t>(limits_.max_candidates + std::uint64_t{1});
  spare_ = arena.take<std::uint32_t>(limits_.max_candidates + std::uint64_t{1});
  start_all(tool_, limits_.max_tools);
  start_all(proxy_, proxies);
  start_all(candidate_, limits_.max_candidates + std::uint64_t{1});
  start_all(listed_, limits_.max_candidates);
}

std::size_t CandidateSearch::required(const Limits& limits) noexcept {
  if (!is_good(limits)) return 0;
  Arena arena;
  CandidateSearch counted;
  counted.limits_ = limits;
  counted.carve(arena);
  return static_cast<std::size_t>(arena.bytes());
}

CandidateSearch::Created CandidateSearch::create(const Limits& limits, std::span<std::byte> memory) noexcept {
  Created created;
  created.requested = required(limits);
  if (created.requested == 0) {
    created.available = memory.size();
    created.error = CreateError::bad_limits;
    return created;
  }
  if (!memory_fits(memory, CreateError::arena_too_small, CreateError::arena_misaligned, created)) return created;
  Arena arena(memory.data());
  created.search.limits_ = limits;
  created.search.carve(arena);
  return created;
}

CandidateSearch::Found CandidateSearch::find(const DeformedSurface& surface, std::span<const Tool> tools,
                                             std::uint64_t& work, std::uint64_t most) noexcept {
  count_ = 0;
  found_ = {};
  for (std::uint32_t i = 0; i <= limits_.max_candidates; ++i) order_[i] = i;
  const auto heeded = static_cast<std::uint32_t>(std::min<std::size_t>(tools.size(), limits_.max_tools));
  const std::uint64_t most_looking = less(most, list_work(limits_.max_candidates, limits_.max_candidates));
  std::uint64_t weights = 0;
  for (const Tool& tool : tools.first(heeded)) weights += weight_of(tool.shape, limits_.max_points);
  for (std::uint32_t t = 0; t < heeded; ++t) {
    const std::uint64_t weight = weight_of(tools[t].shape, limits_.max_points);
    look(surface, tools[t], t, work, work + less(most_looking, work) / weights * weight);
    weights -= weight;
  }
  merge_sort(count_, order_, spare_,
             [this](std::uint32_t a, std::uint32_t b) { return comes_before(candidate_[a], candidate_[b]); });
  for (std::uint32_t i = 0; i < count_; ++i) listed_[i] = candidate_[order_[i]];
  work += list_work(limits_.max_candidates, count_);
  found_.candidates = {listed_, count_};
  return found_;
}

std::uint64_t CandidateSearch::find_work(const DeformedSurface& surface, std::span<const Tool> tools) const noexcept {
  const std::size_t heeded = std::min<std::size_t>(tools.size(), limits_.max_tools);
  const std::uint64_t taken = take_work(limits_.max_candidates);
  std::uint64_t work = list_work(limits_.max_candidates, limits_.max_candidates);
  for (const Tool& tool : tools.first(heeded)) {
    const std::uint64_t box = box_price + tool.shape.distance_work();
    work +=
        tool_price + surface.box_count() * box +
        surface.node_count() * most_node_work(surface, tool.shape, limits_.max_candidates) +
        limits_.max_points * (Proxy::move_work(surface) + taken + beside_work(surface.sizes(), limits_.max_candidates));
  }
  return work;
}

std::uint64_t CandidateSearch::least_find_work(const Limits& limits, const SurfaceSizes& surface) noexcept {
  const std::uint64_t point = least_point_work(surface, limits.max_candidates);
  return list_work(limits.max_candidates, limits.max_candidates) +
         limits.max_tools * (tool_price + (limits.max_points + std::uint64_t{1}) * point);
}

std::uint64_t CandidateSearch::usual_find_work(const Limits& limits, const SurfaceSizes& surface) noexcept {
  constexpr std::uint64_t advances = 3, patches = 2, boxes = 80;
  const Shape simple = Shape::plane();
  const std::uint64_t node = node_price + simple.distance_work() + approach_work(simple, advances) +
                             surface.surround_work() + take_work(limits.max_candidates);
  return least_find_work(limits, surface) +
         limits.max_tools * (limits.max_points * patches * DeformedSurface::patch_work +
                             boxes * (box_price + simple.distance_work())) +
         limits.max_candidates * node;
}

void CandidateSearch::look(const DeformedSurface& surface, const Tool& tool, std::uint32_t number, std::uint64_t& work,
                           std::uint64_t most) noexcept {
  work += tool_price;
  ToolState& state = tool_[number];
  const Placed placed = place(tool.pose);
  state.fault = fault_of(placed.error);
  if (tool.shape.check() != Shape::Error::none) state.fault = ToolFault::bad_shape;
  if (state.fault == ToolFault::none && tool.shape.point_count() > limits_.max_points) {
    state.fault = ToolFault::too_many_points;
  }
  if (state.fault != ToolFault::none) return;
  if (!state.has_history || state.points != tool.shape.point_count()) {
    state.points = tool.shape.point_count();
    state.last = placed.placement;
    start_all(proxy_ + std::size_t{limits_.max_points} * number, state.points);
  }
  const Step step{surface, tool.shape, state.last, placed.placement, number, work, most};
  const bool all_points = look_at_points(step);
  const bool all_nodes = tool.shape.kind() == Shape::Kind::point || look_at_nodes(step);
  found_.unfinished += all_points && all_nodes ? 0 : 1;
  state.has_history = true;
  state.last = placed.placement;
}

// A place in a box is never farther from the box's middle than half its diagonal, and the middle is on its way never
// farther from its end than the way is long: what the tool does not come near by as much cannot be near. False if the
// work did not suffice.
bool CandidateSearch::look_at_nodes(const Step& step) noexcept {
  const std::uint64_t most = less(step.most, most_node_work(step.surface, step.shape, limits_.max_candidates));
  const double radius = step.shape.bounding_radius();
  constexpr double far = std::numeric_limits<double>::infinity();
  // m, how much too far away a ball is, in which there may be nodes
  const auto beyond = [&](const Double3& place, double reach) {
    const Double3 to = step.present.to_tool(place);
    const double near = limits_.margin + reach + norm(to - step.last.to_tool(place));
    return norm(to) - radius <= near ? step.shape.distance(to).distance - near : far;
  };
  const auto box_beyond = [&](const TriangleBox& box) {
    if (step.work > most) return far;
    step.work += box_price + step.shape.distance_work();
    const Double3 low{box.low[0], box.low[1], box.low[2]}, high{box.high[0], box.high[1], box.high[2]};
    return beyond(0.5 * (low + high), 0.5 * norm(high - low));
  };
  step.surface.visit_nearer_first(box_beyond, [&](std::uint32_t patch) {
    for (const std::uint32_t node : step.surface.own_nodes_of(patch)) {
      if (!step.surface.is_touchable(node) || step.work > most) continue;
      step.work += node_price + step.shape.distance_work();
      if (beyond(step.surface.position(node), 0) <= 0) look_at_node(step, node);
    }
  });
  return step.work <= most;
}

void CandidateSearch::look_at_node(const Step& step, std::uint32_t node) noexcept {
  const Double3 position = step.surface.position(node);
  const Approach near = approach(step.shape, step.last, step.present, position, step.work);
  if (!(near.gap <= limits_.margin)) return;
  if (!(dot(step.surface.node_normal(node, step.work), near.normal) <= most_away)) return;
  take({.node = {node, layout::none, layout::none},
        .weight = {1, 0, 0},
        .tool = step.tool,
        .gap = near.gap,
        .normal = near.normal,
        .position = position});
  step.work += take_work(limits_.max_candidates);
}

// false if the work did not suffice for one of them; nodes have as large a share as all points
bool CandidateSearch::look_at_points(const Step& step) noexcept {
  const std::uint64_t points = step.shape.point_count(), taken = take_work(limits_.max_candidates);
  const std::uint64_t beside = beside_work(step.surface.sizes(), limits_.max_candidates);
  const std::uint64_t least = least_point_work(step.surface.sizes(), limits_.max_candidates);
  bool all = true;
  for (std::uint32_t i = 0; i < points; ++i) {
    Proxy& proxy = proxy_[std::size_t{limits_.max_points} * step.tool + i];
    const double margin = limits_.margin + step.shape.point_radius();
    const std::uint64_t share = std::max(less(step.most, step.work) / (2 * points - i), least);
    const std::uint64_t most = step.work + share;
    const Double3 place = step.present.to_model(step.shape.point(i));
    proxy.move(step.surface, place, margin, step.work, most - taken);
    const bool is_near = proxy.point().triangle != layout::none && proxy.height() <= margin;
    if (is_near) take_point(step, i, proxy);
    step.work += taken;
    const bool is_fine = step.shape.point_radius() < limits_.fine_radius && !proxy.is_held();
    if (is_near && is_fine && step.work + beside <= most) take_beside(step, place, proxy);
    all = all && !proxy.is_left_out();
  }
  return all;
}

void CandidateSearch::take_point(const Step& step, std::uint32_t point, const Proxy& proxy) noexcept {
  const auto& [a, b, c] = step.surface.triangle(proxy.point().triangle).node;
  const double* w = proxy.point().weight;
  take({.node = {a, b, c},
        .weight = {w[0], w[1], w[2]},
        .triangle = proxy.point().triangle,
        .tool = step.tool,
        .feature = point,
        .gap = proxy.height() - step.shape.point_radius(),
        .normal = -proxy.normal(),
        .position = proxy.position()});
}

// Where the surface is hollow, as under a small tool, several of its triangles are near, and which is the nearest
// changes from step to step.
void CandidateSearch::take_beside(const Step& step, const Double3& centre, const Proxy& proxy) noexcept {
  const double radius = step.shape.point_radius();
  const std::uint32_t nearest = proxy.point().triangle;
  const auto& corner = step.surface.triangle(nearest).node;
  std::uint32_t places = 1;
  const auto look = [&](std::uint32_t t, int k) {
    step.work += SurfacePrices::triangle;
    bool is_new = t != nearest && places < most_places;  // and not seen around a corner before
    for (const std::uint32_t node : step.surface.triangle(t).node) {
      for (int j = 0; j < k; ++j) is_new = is_new && node != corner[j];
    }
    if (!is_new) return;
    const ClosestSurfacePoint near = step.surface.closest_in(t, centre);
    const double* w = near.point.weight;
    const Double3 way = step.surface.position(near.point) - centre;
    const double distance = norm(way);
    const bool is_within = w[0] > 0 && w[1] > 0 && w[2] > 0 && distance > 0 && distance <= limits_.margin + radius;
    if (!is_within || dot(way, step.surface.triangle_normal(t)) >= 0) return;
    ++places;
    step.work += take_work(limits_.max_candidates);
    const auto& [a, b, c] = step.surface.triangle(t).node;
    take({.node = {a, b, c},
          .weight = {w[0], w[1], w[2]},
          .triangle = t,
          .tool = step.tool,
          .feature = Shape::max_points + t,
          .gap = distance - radius,
          .normal = (1 / distance) * way,
          .position = centre + way});
  };
  for (int k = 0; k < 3; ++k) {
    step.work += step.surface.around_work();
    TrianglePoint at{nearest, {0, 0, 0}};
    at.weight[k] = 1;
    step.surface.visit_around(at, [&](std::uint32_t t) { look(t, k); });
  }
}

// While there are too many, those in order_ are a heap with the shallowest first, which goes; its slot is the next to
// be written to, as beyond the count there stand the slots that are free.
void CandidateSearch::take(Candidate candidate) noexcept {
  candidate.depth = -candidate.gap;
  for (int k = 0; k < 3 && candidate.node[k] < held_out_.size(); ++k) {
    candidate.depth += candidate.weight[k] * double{held_out_[candidate.node[k]]};
  }
  candidate_[order_[count_++]] = candidate;
  if (count_ <= limits_.max_candidates) return;
  const auto order = [this](std::uint32_t a, std::uint32_t b) { return is_deeper(candidate_[a], candidate_[b]); };
  if (found_.left_out == 0) {
    std::make_heap(order_, order_ + count_, order);
  } else {
    std::push_heap(order_, order_ + count_, order);
  }
  std::pop_heap(order_, order_ + count_, order);
  const Candidate& gone = candidate_[order_[--count_]];
  if (found_.left_out == 0 || is_deeper(gone, found_.deepest_left_out)) found_.deepest_left_out = gone;
  ++found_.left_out;
}

}  // namespace greenloop
