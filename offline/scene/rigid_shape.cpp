#include "offline/scene/rigid_shape.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace greenloop::offline {
namespace {

/// Of a box around the origin with these half sides, in `D` dimensions.
template <int D>
double box_clearance(const Eigen::Matrix<double, D, 1>& half, const Eigen::Matrix<double, D, 1>& place,
                     Eigen::Matrix<double, D, 1>& normal) {
  const Eigen::Matrix<double, D, 1> beyond = place.cwiseAbs() - half, outside = beyond.cwiseMax(0);
  const auto sign = [&](Eigen::Index i) { return std::copysign(1, place[i]); };
  const double distance = outside.norm();
  normal.setZero();
  if (distance > 0) {
    for (Eigen::Index i = 0; i < D; ++i) normal[i] = sign(i) * outside[i] / distance;
    return distance;
  }
  Eigen::Index nearest = 0;
  const double depth = beyond.maxCoeff(&nearest);
  normal[nearest] = sign(nearest);
  return depth;
}

Clearance clearance_of(const RigidBox& box, const Eigen::Vector3d& place) {
  Clearance result;
  result.distance = box_clearance<3>((box.high - box.low) / 2, place - (box.high + box.low) / 2, result.normal);
  return result;
}

/// In the plane through the axis and the place, a cylinder is a box.
Clearance clearance_of(const RigidCylinder& bar, const Eigen::Vector3d& place) {
  const double length = (bar.to - bar.from).norm();
  const Eigen::Vector3d axis = (bar.to - bar.from) / length, from_middle = place - (bar.from + bar.to) / 2;
  const double along = axis.dot(from_middle);
  const Eigen::Vector3d across = from_middle - along * axis;
  const double radius = across.norm();
  const Eigen::Vector3d outward = radius > 0 ? Eigen::Vector3d(across / radius) : axis.unitOrthogonal();
  Eigen::Vector2d normal;
  Clearance result;
  result.distance = box_clearance<2>({length / 2, bar.radius}, {along, radius}, normal);
  result.normal = normal[0] * axis + normal[1] * outward;
  return result;
}

}  // namespace

Clearance clearance(const RigidShape& shape, const Eigen::Vector3d& place) {
  return std::visit([&](const auto& s) { return clearance_of(s, place); }, shape);
}

}  // namespace greenloop::offline
