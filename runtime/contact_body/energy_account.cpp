#include "runtime/contact_body/energy_account.hpp"

#include <cmath>

namespace greenloop {

double tool_work(const FeltTool& before, const FeltTool& after) noexcept {
  if (!before.known || !after.known) return 0;
  const Double3 way = after.placement.origin - before.placement.origin;
  Double3 turned;  // small: sine of the angle times the axis
  for (int i = 0; i < 3; ++i) turned += 0.5 * cross(before.placement.axis[i], after.placement.axis[i]);
  return -0.5 * (dot(before.force + after.force, way) + dot(before.torque + after.torque, turned));
}

double slip_work(const Double3& force, const Double3& slip) noexcept { return std::fmax(0, -dot(force, slip)); }

}  // namespace greenloop
