#pragma once

#include <Eigen/Core>
#include <variant>

namespace greenloop::offline {

/// A box along the axes, m.
struct RigidBox {
  Eigen::Vector3d low;
  Eigen::Vector3d high;
};

/// A round bar with flat ends, m.
struct RigidCylinder {
  Eigen::Vector3d from;
  Eigen::Vector3d to;  ///< another place
  double radius = 0;   ///< above 0
};

using RigidShape = std::variant<RigidBox, RigidCylinder>;

/// How far a place is outside of a shape, negative inside, and the way out.
struct Clearance {
  double distance = 0;     ///< m, to the surface
  Eigen::Vector3d normal;  ///< unit, along which the distance grows
};

[[nodiscard]] Clearance clearance(const RigidShape& shape, const Eigen::Vector3d& place);

}  // namespace greenloop::offline
