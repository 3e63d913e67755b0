#include "runtime/display/parts.hpp"

#include "runtime/algebra/merge_sort.hpp"

namespace greenloop {
namespace {

// the edge of a triangle that begins at its corner i
struct Edge {
  std::uint32_t low, high;

  Edge(const Surface::Triangle& triangle, std::uint32_t i) {
    const std::uint32_t a = triangle.node[i], b = triangle.node[(i + 1) % 3];
    low = a < b ? a : b;
    high = a < b ? b : a;
  }
  [[nodiscard]] bool before(const Edge& other) const { return low != other.low ? low < other.low : high < other.high; }
  [[nodiscard]] bool is(const Edge& other) const { return low == other.low && high == other.high; }
};

}  // namespace

bool FinerSurfaceParts::count(const Surface& of, const FinerSurface::Options& wanted) noexcept {
  surface = of;
  options = wanted;
  std::uint64_t vertices = of.node_count(of.level()), triangles = of.triangle_count(of.level());
  for (std::uint32_t k = 0; k <= wanted.added; ++k) {
    if (triangles >= std::uint64_t{1} << 30) return false;
    vertex_count[k] = static_cast<std::uint32_t>(vertices);
    triangle_count[k] = static_cast<std::uint32_t>(triangles);
    vertices += triangles + triangles / 2;  // one for each edge
    triangles *= 4;
  }
  return triangle_count[0] % 2 == 0;
}

void FinerSurfaceParts::carve(Arena& arena) noexcept {
  const std::uint32_t added = options.added, before = added > 0 ? added - 1 : 0;
  halved = arena.take<HalvedEdge>(vertex_count[added] - vertex_count[0]);
  weight = arena.take<LoopWeight>(vertex_count[0]);
  triangle = arena.take<Surface::Triangle>(triangle_count[added]);
  sum = arena.take<Vec4>(vertex_count[before]);
  const std::uint64_t half_edges = added > 0 ? std::uint64_t{3} * triangle_count[before] : 0;
  half_edge = arena.take<std::uint32_t>(half_edges);
  scratch = arena.take<std::uint32_t>(half_edges);
}

bool FinerSurfaceParts::split(std::uint32_t k) noexcept {
  const std::uint32_t count = 3 * triangle_count[k];
  for (std::uint32_t h = 0; h < count; ++h) half_edge[h] = h;
  const auto edge = [this](std::uint32_t h) { return Edge(triangle[h / 3], h % 3); };
  merge_sort(count, half_edge, scratch, [&](std::uint32_t a, std::uint32_t b) { return edge(a).before(edge(b)); });
  // the vertex that halves each half edge
  for (std::uint32_t i = 0; i < count; i += 2) {
    const std::uint32_t a = half_edge[i], b = half_edge[i + 1];
    const Edge shared = edge(a);
    const bool is_third = i + 2 < count && edge(half_edge[i + 2]).is(shared);
    if (!edge(b).is(shared) || is_third || shared.low == shared.high) return false;
    const std::uint32_t vertex = vertex_count[k] + i / 2;
    halved[vertex - vertex_count[0]] = {{shared.low, shared.high},
                                        {triangle[a / 3].node[(a + 2) % 3], triangle[b / 3].node[(b + 2) % 3]}};
    scratch[a] = scratch[b] = vertex;
  }
  // from the last triangle to the first, so that children never overwrite what is still to be split
  for (std::uint32_t t = triangle_count[k]; t-- > 0;) {
    const auto [a, b, c] = triangle[t].node;
    const std::uint32_t* const side = scratch + std::size_t{3} * t;
    const auto ab = side[0], bc = side[1], ca = side[2];
    Surface::Triangle* const child = triangle + std::size_t{4} * t;
    child[3] = {{ab, bc, ca}};
    child[2] = {{ca, bc, c}};
    child[1] = {{ab, b, bc}};
    child[0] = {{a, ab, ca}};
  }
  return true;
}

void FinerSurfaceParts::weigh() noexcept {
  for (std::uint32_t v = 0; v < vertex_count[0]; ++v) weight[v] = {0, 0};  // counts neighbours first
  for (std::uint32_t i = 0; i < vertex_count[1] - vertex_count[0]; ++i) {
    for (const std::uint32_t end : halved[i].end) weight[end].neighbour += 1;
  }
  for (std::uint32_t v = 0; v < vertex_count[0]; ++v) {
    const float neighbours = weight[v].neighbour;
    if (neighbours == 0) {
      weight[v] = {1, 0};
    } else if (neighbours <= 3) {
      weight[v] = {1 - neighbours * 0.1875F, 0.1875F};
    } else {
      weight[v] = {0.625F, 0.375F / neighbours};
    }
  }
}

}  // namespace greenloop
