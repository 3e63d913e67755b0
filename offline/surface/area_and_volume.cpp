#include "offline/surface/area_and_volume.hpp"

#include <Eigen/Geometry>

namespace greenloop::offline {

double surface_area(const TriangleMesh& mesh) {
  double area = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    area += (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]).norm() / 2;
  }
  return area;
}

double enclosed_volume(const TriangleMesh& mesh) {
  if (mesh.triangles.empty()) return 0;
  const Eigen::Vector3d origin = mesh.vertices[mesh.triangles.front()[0]];
  double sixfold = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    sixfold += (mesh.vertices[a] - origin).dot((mesh.vertices[b] - origin).cross(mesh.vertices[c] - origin));
  }
  return sixfold / 6;
}

}  // namespace greenloop::offline
