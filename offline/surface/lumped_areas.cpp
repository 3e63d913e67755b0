#include "offline/surface/lumped_areas.hpp"

#include <Eigen/Geometry>

namespace greenloop::offline {

std::vector<double> lumped_areas(const TriangleMesh& surface) {
  std::vector<double> areas(surface.vertices.size(), 0.0);
  for (const auto& t : surface.triangles) {
    const Eigen::Vector3d ab = surface.vertices[t[1]] - surface.vertices[t[0]];
    const Eigen::Vector3d ac = surface.vertices[t[2]] - surface.vertices[t[0]];
    const double third = ab.cross(ac).norm() / 6.0;
    for (const int v : t) areas[v] += third;
  }
  return areas;
}

}  // namespace greenloop::offline
