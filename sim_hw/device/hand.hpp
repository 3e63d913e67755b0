#pragma once

#include "runtime/algebra/double3.hpp"

namespace greenloop {

/// A hand on the device's handle: a mass on a spring to where the person wants to be, and a damper to the ground.
struct HandParameters {
  double mass = 0.15;      ///< kg, > 0
  double stiffness = 600;  ///< N/m, > 0
  double damping = 12;     ///< N s/m, >= 0
};

/// Where the person wants to be at the start, the middle and the end of a step, m.
struct HandTarget {
  Double3 begin, middle, end;
};

/// m x'' = k (target - x) - b x' + f, integrated by the classical fourth-order Runge-Kutta method.
class Hand {
 public:
  Hand() = default;
  Hand(const HandParameters& parameters, const Double3& position) : parameters_(parameters), position_(position) {}

  /// One step of `dt` seconds under a constant `force` in N. Stable for dt * sqrt(stiffness / mass) < 2.
  void advance(const HandTarget& target, const Double3& force, double dt);

  [[nodiscard]] const Double3& position() const { return position_; }  ///< m
  [[nodiscard]] const Double3& velocity() const { return velocity_; }  ///< m/s

 private:
  [[nodiscard]] Double3 acceleration(const Double3& position, const Double3& velocity, const Double3& target,
                                     const Double3& force) const;

  HandParameters parameters_;
  Double3 position_, velocity_;
};

}  // namespace greenloop
