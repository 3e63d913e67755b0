#pragma once

#include "runtime/algebra/double3.hpp"

namespace greenloop {

/// The point of a triangle nearest to the origin.
struct ClosestPoint {
  double weight[3];         ///< of the corners, in 0..1 with sum 1
  double squared_distance;  ///< from the origin
};

/// The least of the foot of the perpendicular, if it lies inside, and of the nearest points of the three edges; of
/// equally near ones the first. Corners may coincide or lie on a line. For the loop; constant work.
[[nodiscard]] ClosestPoint closest_to_origin(const Double3 (&corner)[3]) noexcept;

}  // namespace greenloop
