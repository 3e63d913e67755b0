#pragma once

#include "runtime/impulse_response.hpp"

namespace greenloop {

/// How far states of motions get, whatever impulses come. In a step that leaves the share d of differences, a state x
/// on an orbit at o becomes x' = d x + (1 - d) o + what the orbit moves in it, at switches and elsewhere (James &
/// Fatahalian 2003, section 5.2). So x stays within `most` + `moves` / (1 - d), and x' - x within 2 (1 - d) `most` + 2
/// `moves`.
struct MotionBound {
  double most = 0;   ///< Euclidean norm over the modes of any state of an orbit
  double moves = 0;  ///< of what any orbit moves in a step
  double left = 0;   ///< d, below 1

  [[nodiscard]] double reach() const { return most + moves / (1 - left); }
  [[nodiscard]] double jump() const { return 2 * (1 - left) * most + 2 * moves; }
};

struct MotionBounds {
  MotionBound displacement;  ///< m, of q_u
  MotionBound velocity;      ///< m/s, of q_v
  MotionBound state;         ///< m, of both: sqrt(|q_u|^2 + rho^2 |q_v|^2)
};

/// Of a body by its limits, which ImpulseResponse::create takes. Start-up; work: linear in the model's coordinates.
[[nodiscard]] MotionBounds motion_bounds(const Model& model, const ImpulseResponse::Limits& limits);

}  // namespace greenloop
