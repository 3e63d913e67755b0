#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace greenloop::offline {

/// One side of a triangle: from `tail` to `head` in face `face`.
struct HalfEdge {
  int tail;
  int head;
  int face;

  [[nodiscard]] bool forward() const { return tail < head; }
};

/// All sides of the triangles, those of the same undirected edge next to each other, edges ordered by their smaller
/// then larger vertex. Sides of length zero by index (a repeated vertex) are left out.
class SurfaceEdges {
 public:
  explicit SurfaceEdges(const std::vector<std::array<int, 3>>& triangles);

  [[nodiscard]] std::size_t size() const { return begin_.size() - 1; }
  [[nodiscard]] std::span<const HalfEdge> operator[](std::size_t edge) const {
    return {sides_.data() + begin_[edge], begin_[edge + 1] - begin_[edge]};
  }

 private:
  std::vector<HalfEdge> sides_;
  std::vector<std::size_t> begin_;  ///< begin_[e] .. begin_[e + 1]: sides of edge e
};

/// Disjoint sets of 0..size-1 that can be united; each is named by its smallest member.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t size);
  [[nodiscard]] int find(int member);
  void unite(int a, int b);

 private:
  std::vector<int> parent_;
};

}  // namespace greenloop::offline
