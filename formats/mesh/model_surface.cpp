#include "formats/mesh/model_surface.hpp"

#include <algorithm>

namespace greenloop {

SemiRegularMesh semi_regular_surface(const ElastostaticView& view) {
  SemiRegularMesh mesh;
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    const LevelView& level = view.level[q];
    for (std::uint32_t i = 0; i < level.counts->node_count; ++i) {
      const float* x = level.nodes[i].position;
      mesh.positions.emplace_back(x[0], x[1], x[2]);
      if (q == 0) {
        mesh.parents.push_back({-1, -1});
      } else {
        const auto [low, high] = std::minmax(level.refinement[i].parent[0], level.refinement[i].parent[1]);
        mesh.parents.push_back({static_cast<int>(low), static_cast<int>(high)});
      }
    }
    mesh.vertex_end.push_back(mesh.positions.size());
  }
  for (std::size_t t = 0; t < view.level[0].counts->base_triangle_count; ++t) {
    const std::uint32_t* corner = view.base_triangles + 3 * t;
    mesh.base_triangles.push_back(
        {static_cast<int>(corner[0]), static_cast<int>(corner[1]), static_cast<int>(corner[2])});
  }
  return mesh;
}

TriangleMesh finest_surface(const ElastostaticView& view) {
  const SemiRegularMesh mesh = semi_regular_surface(view);
  return {mesh.positions, triangles_of_level(mesh, mesh.finest_level())};
}

}  // namespace greenloop
