#pragma once

#include <string_view>

#include "runtime/algebra/double3.hpp"

namespace greenloop {

/// A hand on the device's handle: a mass on a spring to where the person wants to be, and a damper to the ground.
struct HandParameters {
  static constexpr double device_damping = 0.5;  ///< N s/m, of the device alone, which is in that of every hand

  double mass = 0.15;      ///< kg, > 0, with the device's
  double stiffness = 600;  ///< N/m, > 0
  double damping = 12;     ///< N s/m, >= 0
};

/// Who holds the handle.
enum class Holder { person, soft, stiff, absent };

inline constexpr std::string_view holder_names[] = {"person", "soft", "stiff", "absent"};

/// absent: the device alone, which a rubber band leads to where the script is.
constexpr HandParameters hand_of(Holder holder) {
  constexpr HandParameters soft{0.1, 150, 2}, stiff{0.3, 3000, 30}, absent{0.05, 20, HandParameters::device_damping};
  return holder == Holder::soft     ? soft
         : holder == Holder::stiff  ? stiff
         : holder == Holder::absent ? absent
                                    : HandParameters{};
}

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
