#include "offline/pipeline/vertex_map.hpp"

#include "formats/mesh/surface_io.hpp"
#include "offline/remesh/triangle_tree.hpp"

namespace greenloop::offline {
namespace {

layout::VertexRecord record_of(const TriangleMesh& mesh, const SurfacePoint& place) {
  layout::VertexRecord record{};
  const auto& corners = mesh.triangles[static_cast<std::size_t>(place.triangle)];
  const Eigen::Vector3d weights = place.weights.cwiseMax(0) / place.weights.cwiseMax(0).sum();
  for (int k = 0; k < 3; ++k) {
    record.node[k] = static_cast<std::uint32_t>(corners[static_cast<std::size_t>(k)]);
    record.weight[k] = static_cast<float>(weights[k]);
  }
  return record;
}

}  // namespace

std::vector<layout::VertexRecord> vertex_map(const MeshSource& source, const SemiRegularMesh& model) {
  const TriangleMesh surface = read_surface(source.path);
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& vertex : surface.vertices) box.extend(vertex);
  const double metres = source.scale(box);
  const TriangleMesh finest{model.positions, triangles_of_level(model, model.finest_level())};
  const TriangleTree tree(finest);
  std::vector<layout::VertexRecord> map;
  map.reserve(surface.vertices.size());
  for (const Eigen::Vector3d& vertex : surface.vertices) {
    map.push_back(record_of(finest, tree.closest(metres * vertex)));
  }
  return map;
}

}  // namespace greenloop::offline
