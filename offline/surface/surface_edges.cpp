#include "offline/surface/surface_edges.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace greenloop::offline {

SurfaceEdges::SurfaceEdges(const std::vector<std::array<int, 3>>& triangles) {
  sides_.reserve(3 * triangles.size());
  for (std::size_t f = 0; f < triangles.size(); ++f) {
    for (std::size_t i = 0; i < 3; ++i) {
      const int tail = triangles[f][i];
      const int head = triangles[f][(i + 1) % 3];
      if (tail != head) {
        sides_.push_back({tail, head, static_cast<int>(f)});
      }
    }
  }
  const auto edge = [](const HalfEdge& side) { return std::minmax({side.tail, side.head}); };
  std::sort(sides_.begin(), sides_.end(), [&](const HalfEdge& s, const HalfEdge& t) {
    return std::tuple(edge(s), s.face, s.tail) < std::tuple(edge(t), t.face, t.tail);
  });
  begin_.push_back(0);
  for (std::size_t i = 1; i <= sides_.size(); ++i) {
    if (i == sides_.size() || edge(sides_[i]) != edge(sides_[i - 1])) {
      begin_.push_back(i);
    }
  }
  if (sides_.empty()) {
    begin_.assign(1, 0);
  }
}

DisjointSets::DisjointSets(std::size_t size) : parent_(size) { std::iota(parent_.begin(), parent_.end(), 0); }

int DisjointSets::find(int member) {
  while (parent_[member] != member) {
    parent_[member] = parent_[parent_[member]];
    member = parent_[member];
  }
  return member;
}

void DisjointSets::unite(int a, int b) {
  const auto [low, high] = std::minmax({find(a), find(b)});
  parent_[high] = low;
}

}  // namespace greenloop::offline
