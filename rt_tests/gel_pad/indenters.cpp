#include "rt_tests/gel_pad/indenters.hpp"

#include <numbers>

namespace greenloop::gel_pad {
namespace {

constexpr double ball_radius = 6e-3, cylinder_radius = 4e-3, half_cylinder = 2e-3, edge_radius = 1e-3,
                 half_edge = 2.5e-3;  // m

}  // namespace

Pose Indenter::at(double deep) const {
  Pose pose;
  pose.position = {0, 0, thickness + lowest - deep};
  for (int k = 0; k < 4; ++k) pose.quaternion[k] = quaternion[k];
  return pose;
}

std::vector<Indenter> indenters() {
  const double half = std::numbers::sqrt2 / 2;
  const Shape cylinder = Shape::capsule(cylinder_radius, half_cylinder), edge = Shape::capsule(edge_radius, half_edge);
  return {{"ball", Shape::sphere(ball_radius), {1, 0, 0, 0}, ball_radius, 0.6e-3},
          {"cylinder", cylinder, {half, 0, half, 0}, cylinder_radius, 0.5e-3},
          {"edge", edge, {half, half, 0, 0}, edge_radius, 0.4e-3}};
}

}  // namespace greenloop::gel_pad
