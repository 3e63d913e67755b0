#include "runtime/friction/energy.hpp"

namespace greenloop {

void EnergyAccount::add(std::span<const EnergyContact> contacts) noexcept {
  stored = 0;
  for (const EnergyContact& contact : contacts) {
    const Double3& force = contact.force;
    const Double3 moved = contact.shift - contact.last_shift;
    const Double3 slip = moved - contact.way;
    const Double3& normal = contact.normal;
    const double closed = -dot(force, normal) * dot(slip, normal);
    const Double3 carried = contact.by_loads - contact.last_by_loads;
    in += dot(force, contact.way);
    from_loads -= dot(force, carried);
    stored += dot(force, contact.shift - contact.by_loads) / 2;
    dissipated -= dot(force, slip) + closed;
    lost += closed + dot(force - contact.last_force, moved - carried) / 2;
  }
}

}  // namespace greenloop
