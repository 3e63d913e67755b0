#include "formats/mesh/coarse_mesh.hpp"

namespace greenloop {

SemiRegularMesh coarse_mesh(const SemiRegularMesh& mesh, std::size_t level) {
  const auto end = static_cast<std::ptrdiff_t>(mesh.vertex_end[level]);
  return {.positions = {mesh.positions.begin(), mesh.positions.begin() + end},
          .vertex_end = {mesh.vertex_end.begin(), mesh.vertex_end.begin() + static_cast<std::ptrdiff_t>(level) + 1},
          .parents = {mesh.parents.begin(), mesh.parents.begin() + end},
          .base_triangles = mesh.base_triangles};
}

}  // namespace greenloop
