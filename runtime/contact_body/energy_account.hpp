#pragma once

#include "runtime/algebra/double3.hpp"
#include "runtime/contact/pose.hpp"
#include "runtime/contact_body.hpp"

namespace greenloop {

/// What a tool felt where it was in a step.
struct FeltTool {
  Placement placement;
  Double3 force, torque;  ///< on the tool, torque about placement.origin
  bool known = false;
};

/// Work of the way from one step to the next, J, that a tool does on the body: by the mean of what it feels at both
/// ends (trapezoidal rule). 0 if one is not known. Constant work.
[[nodiscard]] double tool_work(const FeltTool& before, const FeltTool& after) noexcept;

/// Dissipated where a contact slipped in a step, J: never negative. slip: m, along the surface.
[[nodiscard]] double slip_work(const Double3& force, const Double3& slip) noexcept;

}  // namespace greenloop
