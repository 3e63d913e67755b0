#include "runtime/contact/pose.hpp"

#include <cmath>

namespace greenloop {

Placed place(const Pose& pose) noexcept {
  const auto& [w, x, y, z] = pose.quaternion;
  const double squared = w * w + x * x + y * y + z * z;
  const Double3& at = pose.position;
  if (!std::isfinite(at.x) || !std::isfinite(at.y) || !std::isfinite(at.z) || !std::isfinite(w) || !std::isfinite(x) ||
      !std::isfinite(y) || !std::isfinite(z)) {
    return {PoseError::not_finite, {}};
  }
  if (std::abs(at.x) > Placement::farthest || std::abs(at.y) > Placement::farthest ||
      std::abs(at.z) > Placement::farthest) {
    return {PoseError::too_far, {}};
  }
  if (!(std::abs(std::sqrt(squared) - 1) <= Placement::unit_tolerance)) return {PoseError::not_unit, {}};
  const double s = 2 / squared;
  Placed placed;
  placed.placement.origin = at;
  placed.placement.axis[0] = {1 - s * (y * y + z * z), s * (x * y + w * z), s * (x * z - w * y)};
  placed.placement.axis[1] = {s * (x * y - w * z), 1 - s * (x * x + z * z), s * (y * z + w * x)};
  placed.placement.axis[2] = {s * (x * z + w * y), s * (y * z - w * x), 1 - s * (x * x + y * y)};
  return placed;
}

}  // namespace greenloop
