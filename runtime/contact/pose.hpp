#pragma once

#include <cstdint>

#include "runtime/algebra/double3.hpp"

namespace greenloop {

/// Where a rigid tool is, in the frame of the model.
struct Pose {
  Double3 position;                     ///< m, of the tool's origin
  double quaternion[4] = {1, 0, 0, 0};  ///< w, x, y, z of unit length: turns the tool's axes into the model's
};

enum class PoseError : std::uint8_t {
  none,
  not_finite,
  too_far,   ///< a coordinate of more than Placement::farthest
  not_unit,  ///< the quaternion's length differs from 1 by more than Placement::unit_tolerance
};

/// A pose as a rotation and an origin.
struct Placement {
  static constexpr double farthest = 1e6;         ///< m
  static constexpr double unit_tolerance = 1e-2;  ///< within which a quaternion is brought to unit length

  Double3 origin;
  Double3 axis[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};  ///< the tool's, in the model's frame

  /// A place of the model in the tool's frame, m.
  [[nodiscard]] Double3 to_tool(const Double3& place) const noexcept { return turned_back(place - origin); }
  [[nodiscard]] Double3 to_model(const Double3& place) const noexcept { return origin + turned(place); }
  /// A direction of the tool in the model's frame, and back.
  [[nodiscard]] Double3 turned(const Double3& v) const noexcept {
    return v.x * axis[0] + v.y * axis[1] + v.z * axis[2];
  }
  [[nodiscard]] Double3 turned_back(const Double3& v) const noexcept {
    return {dot(v, axis[0]), dot(v, axis[1]), dot(v, axis[2])};
  }
};

struct Placed {
  PoseError error = PoseError::none;
  Placement placement;  ///< of use only without an error
  explicit operator bool() const noexcept { return error == PoseError::none; }
};

/// Checks a pose. For the loop; constant work.
[[nodiscard]] Placed place(const Pose& pose) noexcept;

}  // namespace greenloop
