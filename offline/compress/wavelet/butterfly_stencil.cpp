#include "offline/compress/wavelet/butterfly_stencil.hpp"

#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <utility>

namespace greenloop::offline {
namespace {

// the triangles of a closed surface at each of its edges
class EdgeTriangles {
 public:
  explicit EdgeTriangles(const std::vector<std::array<int, 3>>& triangles) {
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      const auto [a, b, c] = triangles[t];
      add(a, b, {t, c});
      add(b, c, {t, a});
      add(c, a, {t, b});
    }
  }

  struct Side {
    std::size_t triangle = 0;
    int corner = 0;  // opposite to the edge
  };

  // two sides, or none
  [[nodiscard]] const std::vector<Side>* sides(int a, int b) const {
    const auto found = sides_.find(std::minmax(a, b));
    return found != sides_.end() && found->second.size() == 2 ? &found->second : nullptr;
  }

  // the corner across an edge of `triangle`
  [[nodiscard]] std::optional<std::uint32_t> across(int a, int b, std::size_t triangle) const {
    const auto* both = sides(a, b);
    if (both == nullptr) return {};
    return static_cast<std::uint32_t>((*both)[both->front().triangle == triangle ? 1 : 0].corner);
  }

 private:
  void add(int a, int b, Side side) { sides_[std::minmax(a, b)].push_back(side); }

  std::map<std::pair<int, int>, std::vector<Side>> sides_;
};

layout::StencilRecord stencil_at(const EdgeTriangles& edges, const std::array<int, 2>& parents) {
  const auto* wings = edges.sides(parents[0], parents[1]);
  if (wings == nullptr) return no_stencil;
  layout::StencilRecord stencil = no_stencil;
  for (std::size_t side = 0; side < 2; ++side) {
    const auto& [triangle, wing] = (*wings)[side];
    stencil.wing[side] = static_cast<std::uint32_t>(wing);
    for (std::size_t end = 0; end < 2; ++end) {
      const auto outer = edges.across(parents[end], wing, triangle);
      if (!outer) return no_stencil;
      stencil.outer[2 * side + end] = *outer;
    }
  }
  return stencil;
}

}  // namespace

std::vector<layout::StencilRecord> butterfly_stencils(const SemiRegularMesh& mesh, std::size_t level) {
  const EdgeTriangles edges(triangles_of_level(mesh, static_cast<int>(level) - 1));
  std::vector<layout::StencilRecord> stencils;
  stencils.reserve(mesh.vertex_end[level] - mesh.vertex_end[level - 1]);
  for (std::size_t node = mesh.vertex_end[level - 1]; node < mesh.vertex_end[level]; ++node) {
    stencils.push_back(stencil_at(edges, mesh.parents[node]));
  }
  return stencils;
}

}  // namespace greenloop::offline
