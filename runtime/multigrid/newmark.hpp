#pragma once

namespace greenloop {

/// Newmark's method for a step dt in accelerations: u = u* + beta dt^2 a, v = v* + gamma dt a, where u*, v* follow from
/// the step before (Newmark 1959). Without numerical damping the average acceleration, which keeps the energy of linear
/// motion; with damping d, gamma = 1/2 + d and beta = (1 + d)^2 / 4, which stays stable whatever dt is.
struct Newmark {
  float time_step = 0;
  float gamma = 0.5F, beta = 0.25F;
  float mass_damping = 0, stiffness_damping = 0;  ///< Rayleigh's alpha, 1/s, and beta, s

  constexpr Newmark(float dt, float numerical_damping, float alpha, float viscous)
      : time_step(dt),
        gamma(0.5F + numerical_damping),
        beta(0.25F * (1 + numerical_damping) * (1 + numerical_damping)),
        mass_damping(alpha),
        stiffness_damping(viscous) {}
  constexpr Newmark() = default;

  [[nodiscard]] constexpr float displacement_per_acceleration() const { return beta * time_step * time_step; }
  [[nodiscard]] constexpr float rate_per_acceleration() const { return gamma * time_step; }
  /// Of K and M in the operator that a change of displacement meets: forces, damping and inertia.
  [[nodiscard]] constexpr float stiffness_scale() const {
    return 1 + stiffness_damping * rate_per_acceleration() / displacement_per_acceleration();
  }
  [[nodiscard]] constexpr float mass_scale() const {
    return (1 + mass_damping * rate_per_acceleration()) / displacement_per_acceleration();
  }
};

}  // namespace greenloop
