#pragma once

#include <bit>
#include <cstdint>
#include <span>

#include "formats/layout.hpp"
#include "runtime/algebra/double3.hpp"
#include "runtime/memory/arena.hpp"
#include "runtime/surface.hpp"

namespace greenloop {

/// A box around some triangles, m.
struct TriangleBox {
  float low[3], high[3];
};

/// How far from a position it is still worth to look: as far as the least distance found, and what that may be wrong
/// by.
class Reach {
 public:
  /// extent: m, of the surface from the origin, as a sum over x, y and z.
  Reach(const Double3& position, double extent) noexcept;

  /// Whether something whose true squared distance is at least this may be as near as what was found.
  [[nodiscard]] bool covers(double squared_distance) const noexcept { return squared_distance <= bound_; }
  /// Something is that near.
  void shrink(double squared_distance) noexcept;

 private:
  double slack_;  ///< m, more than the rounding of a computed distance
  double bound_;
};

/// Triangles halved again and again by their middles along the longest side of their box: a balanced binary tree of
/// boxes, without a pointer, of which box i has the children 2i + 1 and 2i + 2.
class TriangleTree {
 public:
  static constexpr std::uint32_t leaf = 4;  ///< triangles in a leaf, at most

  /// Room for `count` triangles, at least 1 and at most 2^30.
  void carve(Arena& arena, std::uint32_t count) noexcept;

  /// Start-up; n log n. Both arrays must stay.
  void build(const layout::NodeRecord* nodes, const Surface::Triangle* triangles) noexcept;

  /// Calls look(triangle, reach) for every triangle whose box is within reach, nearer boxes first; `look` may shrink
  /// the reach. For the loop; work: at most all boxes, fewer than twice the triangles, and all triangles.
  template <class Look>
  void visit(const Double3& position, Look look) const noexcept;

  /// Halvings that lead from all triangles to a leaf.
  [[nodiscard]] std::uint32_t depth() const noexcept { return depth_; }
  /// The triangles of a box.
  [[nodiscard]] std::span<const std::uint32_t> in(std::uint32_t box) const noexcept {
    return {order_ + begin(box), order_ + end(box)};
  }

 private:
  // its triangles' places in `order_`: a box at depth d is the k-th of 2^d, which share them out equally
  [[nodiscard]] std::uint32_t begin(std::uint32_t box) const noexcept;
  [[nodiscard]] std::uint32_t end(std::uint32_t box) const noexcept {
    return ((box + 1) & (box + 2)) == 0 ? count_ : begin(box + 1);
  }
  [[nodiscard]] std::uint32_t first_leaf() const noexcept { return (std::uint32_t{1} << depth_) - 1; }

  std::uint32_t count_ = 0;
  std::uint32_t depth_ = 0;  ///< of the leaves
  double extent_ = 0;
  std::uint32_t* order_ = nullptr;  ///< [count] triangles, those of a box one after another
  TriangleBox* boxes_ = nullptr;    ///< [2^(depth + 1) - 1]
};

[[nodiscard]] double squared_distance(const TriangleBox& box, const Double3& position) noexcept;

/// Calls look(leaf) for every leaf of a balanced tree of boxes whose squared distance from a position is within(it), as
/// the boxes around it, nearer ones first; what `look` finds may leave less within. For the loop; work: at most all
/// boxes.
template <class Within, class Look>
void visit_nearest(const TriangleBox* boxes, std::uint32_t first_leaf, const Double3& position, Within within,
                   Look look) {
  std::uint32_t waiting[32];
  std::uint32_t count = 0;
  waiting[count++] = 0;
  while (count > 0) {
    const std::uint32_t box = waiting[--count];
    if (!within(squared_distance(boxes[box], position))) continue;
    if (box < first_leaf) {
      const std::uint32_t left = 2 * box + 1;
      const bool left_first = squared_distance(boxes[left], position) <= squared_distance(boxes[left + 1], position);
      waiting[count++] = left_first ? left + 1 : left;
      waiting[count++] = left_first ? left : left + 1;
    } else {
      look(box);
    }
  }
}

inline std::uint32_t TriangleTree::begin(std::uint32_t box) const noexcept {
  const auto depth = static_cast<std::uint32_t>(std::bit_width(box + 1) - 1);
  const std::uint64_t k = std::uint64_t{box} + 1 - (std::uint64_t{1} << depth);
  return static_cast<std::uint32_t>(k * count_ >> depth);
}

template <class Look>
void TriangleTree::visit(const Double3& position, Look look) const noexcept {
  Reach reach(position, extent_);
  const auto within = [&](double squared_distance) { return reach.covers(squared_distance); };
  visit_nearest(boxes_, first_leaf(), position, within, [&](std::uint32_t box) {
    for (const std::uint32_t t : in(box)) look(t, reach);
  });
}

}  // namespace greenloop
