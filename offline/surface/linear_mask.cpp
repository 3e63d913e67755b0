#include "offline/surface/linear_mask.hpp"

#include <Eigen/Geometry>
#include <algorithm>

namespace greenloop::offline {

Eigen::Vector3d mask_integrals(const Eigen::Matrix3d& corners, const Eigen::Vector3d& centre, double radius) {
  const Eigen::Vector3d ab = corners.col(1) - corners.col(0), ac = corners.col(2) - corners.col(0);
  const double edge = std::max({ab.norm(), ac.norm(), (ac - ab).norm()});
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  if ((corners.col(0) - centre).norm() >= radius + edge) return sum;
  constexpr double kMostParts = 8.0;
  const int parts = static_cast<int>(std::clamp(2.0 * edge / radius + 1.0, 2.0, kMostParts));
  const double area = 0.5 * ab.cross(ac).norm() / (parts * parts);
  for (int i = 0; i < parts; ++i) {
    for (int j = 0; j < 2 * (parts - i) - 1; ++j) {
      // parts stand in rows, every other one upside down
      const double third = j % 2 == 0 ? 1.0 / 3.0 : 2.0 / 3.0;
      const int pair = j / 2;
      const double v = (i + third) / parts, w = (pair + third) / parts;
      const Eigen::Vector3d weight(1.0 - v - w, v, w);
      sum += std::max(0.0, 1.0 - (corners * weight - centre).norm() / radius) * area * weight;
    }
  }
  return sum;
}

}  // namespace greenloop::offline
