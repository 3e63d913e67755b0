#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace greenloop {

/// A triangle surface. Vertices in the unit of the file it came from until a scene scales them to metres.
/// Triangles are counter-clockwise seen from outside. Offline only.
struct TriangleMesh {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::array<int, 3>> triangles;
};

}  // namespace greenloop
