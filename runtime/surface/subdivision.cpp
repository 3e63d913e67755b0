#include "runtime/surface/subdivision.hpp"

#include <algorithm>
#include <cstring>

#include "runtime/algebra/merge_sort.hpp"

namespace greenloop {
namespace {

std::uint64_t edge(std::uint32_t a, std::uint32_t b) {
  return a < b ? std::uint64_t{a} << 32 | b : std::uint64_t{b} << 32 | a;
}

std::uint64_t halved_edge(const LevelView& level, std::uint32_t i) {
  return edge(level.refinement[i].parent[0], level.refinement[i].parent[1]);
}

// the node that halves the edge a b; none if there is none
std::uint32_t middle(const LevelView& level, const std::uint32_t* by_edge, std::uint32_t a, std::uint32_t b) {
  const std::uint64_t wanted = edge(a, b);
  const std::uint32_t* const end = by_edge + level.counts->node_count;
  const std::uint32_t* const found = std::lower_bound(
      by_edge, end, wanted, [&](std::uint32_t i, std::uint64_t value) { return halved_edge(level, i) < value; });
  return found != end && halved_edge(level, *found) == wanted ? level.node_begin + *found : layout::none;
}

}  // namespace

void Subdivision::carve(Arena& arena, const ModelView& view, std::uint32_t level) noexcept {
  std::uint32_t most = 0;
  for (std::uint32_t q = 1; q <= level; ++q) {
    most = std::max(most, view.level[q].counts->node_count);
  }
  by_edge_ = arena.take<std::uint32_t>(most);
  scratch_ = arena.take<std::uint32_t>(most);
}

bool Subdivision::fill(const ModelView& view, std::uint32_t level, Surface::Triangle* triangles) noexcept {
  std::memcpy(triangles->node, view.base_triangles, sizeof *triangles * view.level[0].counts->base_triangle_count);
  for (std::uint32_t q = 1; q <= level; ++q) {
    if (!split(view, q, triangles)) return false;
  }
  return true;
}

// from the last triangle to the first, so that children never overwrite what is still to be split
bool Subdivision::split(const ModelView& view, std::uint32_t level, Surface::Triangle* triangles) noexcept {
  const LevelView& at = view.level[level];
  for (std::uint32_t i = 0; i < at.counts->node_count; ++i) by_edge_[i] = i;
  merge_sort(at.counts->node_count, by_edge_, scratch_,
             [&](std::uint32_t a, std::uint32_t b) { return halved_edge(at, a) < halved_edge(at, b); });
  for (std::size_t t = static_cast<std::size_t>(subdivided_count(view, level - 1)); t-- > 0;) {
    const auto [a, b, c] = triangles[t].node;
    const std::uint32_t ab = middle(at, by_edge_, a, b), bc = middle(at, by_edge_, b, c),
                        ca = middle(at, by_edge_, c, a);
    if (ab == layout::none || bc == layout::none || ca == layout::none) return false;
    triangles[4 * t + 3] = {{ab, bc, ca}};
    triangles[4 * t + 2] = {{ca, bc, c}};
    triangles[4 * t + 1] = {{ab, b, bc}};
    triangles[4 * t] = {{a, ab, ca}};
  }
  return true;
}

}  // namespace greenloop
