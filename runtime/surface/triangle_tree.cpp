#include "runtime/surface/triangle_tree.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace greenloop {
namespace {

constexpr TriangleBox empty_box{{HUGE_VALF, HUGE_VALF, HUGE_VALF}, {-HUGE_VALF, -HUGE_VALF, -HUGE_VALF}};

void enclose(const float (&low)[3], const float (&high)[3], TriangleBox& box) {
  for (int axis = 0; axis < 3; ++axis) {
    box.low[axis] = std::min(box.low[axis], low[axis]);
    box.high[axis] = std::max(box.high[axis], high[axis]);
  }
}

void enclose(const layout::NodeRecord* nodes, const Surface::Triangle& triangle, TriangleBox& box) {
  for (const std::uint32_t node : triangle.node) enclose(nodes[node].position, nodes[node].position, box);
}

int longest_side(const TriangleBox& box) {
  int longest = 0;
  for (int axis = 1; axis < 3; ++axis) {
    if (box.high[axis] - box.low[axis] > box.high[longest] - box.low[longest]) longest = axis;
  }
  return longest;
}

double magnitude(double value) { return value < 0 ? -value : value; }

}  // namespace

Reach::Reach(const Double3& position, double extent) noexcept
    : slack_(0x1p-44 * (magnitude(position.x) + magnitude(position.y) + magnitude(position.z) + extent)),
      bound_(std::numeric_limits<double>::infinity()) {}

void Reach::shrink(double squared_distance) noexcept {
  const double distance = std::sqrt(squared_distance) + slack_;
  bound_ = distance * distance;
}

double squared_distance(const TriangleBox& box, const Double3& position) noexcept {
  const double at[3] = {position.x, position.y, position.z};
  double sum = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double below = double{box.low[axis]} - at[axis], above = at[axis] - double{box.high[axis]};
    const double outside = std::max(0.0, std::max(below, above));
    sum += outside * outside;
  }
  return sum;
}

void TriangleTree::carve(Arena& arena, std::uint32_t count) noexcept {
  count_ = count;
  depth_ = 0;
  while ((std::uint64_t{leaf} << depth_) < count) ++depth_;
  order_ = arena.take<std::uint32_t>(count);
  boxes_ = arena.take<TriangleBox>(2 * std::uint64_t{first_leaf()} + 1);
}

void TriangleTree::build(const layout::NodeRecord* nodes, const Surface::Triangle* triangles) noexcept {
  for (std::uint32_t i = 0; i < count_; ++i) order_[i] = i;
  const std::uint32_t boxes = 2 * first_leaf() + 1;
  for (std::uint32_t box = 0; box < boxes; ++box) {
    std::uint32_t *const some = order_ + begin(box), *const last = order_ + end(box);
    boxes_[box] = empty_box;
    for (const std::uint32_t* t = some; t < last; ++t) enclose(nodes, triangles[*t], boxes_[box]);
    if (box >= first_leaf()) continue;
    const int axis = longest_side(boxes_[box]);
    const auto middle = [&](std::uint32_t t) {
      const auto& [a, b, c] = triangles[t].node;
      return nodes[a].position[axis] + nodes[b].position[axis] + nodes[c].position[axis];
    };
    std::nth_element(some, order_ + begin(2 * box + 2), last, [&](std::uint32_t s, std::uint32_t t) {
      const float at_s = middle(s), at_t = middle(t);
      return at_s != at_t ? at_s < at_t : s < t;
    });
  }
  extent_ = 0;
  for (int axis = 0; axis < 3; ++axis) {
    extent_ += std::max(magnitude(boxes_[0].low[axis]), magnitude(boxes_[0].high[axis]));
  }
}

}  // namespace greenloop
