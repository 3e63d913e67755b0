#pragma once

#include <cstddef>
#include <span>

#include "runtime/vec.hpp"

namespace greenloop {

/// A force (N) and its torque (N m) about a point.
struct Wrench {
  Vec3 force;
  Vec3 torque;
};

/// The sum of forces at positions, [as many] m, and of their torques about a point: of a tool by the part of
/// Response::force that is of its contacts. Summed in double, in order. For the loop; work: 20 operations a force.
[[nodiscard]] inline Wrench total_wrench(std::span<const Vec3> position, std::span<const Vec3> force,
                                         Vec3 about) noexcept {
  double sum[3] = {};
  double turn[3] = {};
  for (std::size_t i = 0; i < position.size() && i < force.size(); ++i) {
    const double f[3] = {force[i].x, force[i].y, force[i].z};
    const double arm[3] = {double{position[i].x} - about.x, double{position[i].y} - about.y,
                           double{position[i].z} - about.z};
    for (std::size_t r = 0; r < 3; ++r) {
      sum[r] += f[r];
      turn[r] += arm[(r + 1) % 3] * f[(r + 2) % 3] - arm[(r + 2) % 3] * f[(r + 1) % 3];
    }
  }
  const auto rounded = [](const double(&x)[3]) {
    return Vec3{static_cast<float>(x[0]), static_cast<float>(x[1]), static_cast<float>(x[2])};
  };
  return {rounded(sum), rounded(turn)};
}

}  // namespace greenloop
