#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace greenloop {

/// A volume of linear tetrahedra, each positively oriented: det[b-a, c-a, d-a] > 0. Offline only.
struct TetrahedralMesh {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::array<int, 4>> tetrahedra;
};

}  // namespace greenloop
