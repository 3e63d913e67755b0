#include "sim_hw/device/hand.hpp"

namespace greenloop {

Double3 Hand::acceleration(const Double3& position, const Double3& velocity, const Double3& target,
                           const Double3& force) const {
  const Double3 spring = parameters_.stiffness * (target - position);
  return (1 / parameters_.mass) * (spring - parameters_.damping * velocity + force);
}

void Hand::advance(const HandTarget& target, const Double3& force, double dt) {
  const double half = 0.5 * dt;
  const Double3 v1 = velocity_, a1 = acceleration(position_, v1, target.begin, force);
  const Double3 v2 = velocity_ + half * a1, a2 = acceleration(position_ + half * v1, v2, target.middle, force);
  const Double3 v3 = velocity_ + half * a2, a3 = acceleration(position_ + half * v2, v3, target.middle, force);
  const Double3 v4 = velocity_ + dt * a3, a4 = acceleration(position_ + dt * v3, v4, target.end, force);
  position_ += (dt / 6) * (v1 + 2 * v2 + 2 * v3 + v4);
  velocity_ += (dt / 6) * (a1 + 2 * a2 + 2 * a3 + a4);
}

}  // namespace greenloop
