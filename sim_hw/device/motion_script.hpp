#pragma once

#include <vector>

#include "runtime/algebra/double3.hpp"

namespace greenloop {

/// Where a person wants a probe to be, in the frame of the body.
struct ProbeTarget {
  Double3 centre;                       ///< m
  double quaternion[4] = {1, 0, 0, 0};  ///< w, x, y, z, of unit length
};

/// Part of a motion: from the first to the last knot, starting and ending at rest.
struct MotionSegment {
  double duration = 0;         ///< share of the script, in any unit
  std::vector<Double3> knots;  ///< m, at least one; passed at equal intervals
  /// The probe turns about this from one of these to the other: the tangent of a quarter of the angle times a unit
  /// vector.
  Double3 turned_from, turned_to;
};

/// The motion of one probe, made of segments and polynomials in time only.
class MotionScript {
 public:
  /// `seconds` is how long all segments together take; afterwards they begin again.
  MotionScript(std::vector<MotionSegment> segments, double seconds);

  [[nodiscard]] ProbeTarget target(double time) const;

 private:
  std::vector<MotionSegment> segments_;
  std::vector<double> end_;  ///< s, when each segment ends
};

/// 6 s^5 - 15 s^4 + 10 s^3: from 0 to 1 with zero speed and acceleration at both ends; s in [0, 1].
[[nodiscard]] constexpr double smoothstep(double s) { return s * s * s * (10 + s * (6 * s - 15)); }

}  // namespace greenloop
