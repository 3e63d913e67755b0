#pragma once

#include "runtime/algebra/block.hpp"
#include "runtime/constraint.hpp"

namespace greenloop {

// Coulomb's law of one contact, in space: n is the tool's outward normal there, f the force of the tool on the body,
// and u the displacement of the body's point from where it would touch the tool and stick to it. Normal force and gap
// u.n are at least 0 and one of them is; the friction force t, the rest of f, is at most mu f.n, and where the point
// slips, it is that and against the slip.

/// Dot product of xyz; the fourth lanes do not count.
inline float dot3(Float4 a, Float4 b) {
  const Float4 product = a * b;
  return (product[0] + product[1]) + product[2];
}

inline Float4 cross(Float4 a, Float4 b) {
  return Float4{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0], 0.0F};
}

/// A contact with the compliance of its own point, in the frame of its normal and of the principal axes of what
/// remains tangentially where the normal force gives way.
struct FrictionContact {
  Float4 normal{};         ///< unit
  Float4 tangent[2]{};     ///< unit
  float friction = 0;      ///< mu
  float stiffness = 0;     ///< normal, of a point without friction, N/m
  float coupling[2] = {};  ///< normal force that a tangential one takes away, N/N
  float compliance[2]{};   ///< tangential, where the normal displacement is held, m/N
  float scale = 0;         ///< N/m, of displacements in the natural map: a mean stiffness
};

/// Coefficients above this act as it does: a wider cone's normal force vanishes in the rounding of its friction force.
inline constexpr float most_friction = 1000;

/// normal: unit, with a fourth lane of 0; friction >= 0; compliance: of the point, symmetric and positive definite.
/// False if it is not, or if something is not finite. For the loop, constant work.
[[nodiscard]] bool set_friction_contact(Float4 normal, float friction, const Block<3>& compliance,
                                        FrictionContact& contact) noexcept;

/// Nearest force of the friction cone (Euclid's distance). For the loop, constant work.
[[nodiscard]] Float4 cone_projection(const FrictionContact& contact, Float4 force) noexcept;

/// The same, in the cone for all that rounding does. For the loop, constant work.
[[nodiscard]] Float4 force_in_cone(const FrictionContact& contact, Float4 force) noexcept;

/// The force with which the law holds where u = free + compliance f; it lies in the cone. Sticking is tried before
/// slipping (the enumerative solver of Acary & Brogliato, Numerical Methods for Nonsmooth Dynamical Systems, 13.7.4);
/// the slip is found by Newton steps on one scalar, `multiplier`, slip per friction force, m/N: what it is handed is
/// where they start. For the loop; work: at most a dozen steps.
[[nodiscard]] Float4 local_force(const FrictionContact& contact, Float4 free, float& multiplier) noexcept;

/// The inverse of the point's compliance times `displacement`. For the loop, constant work.
[[nodiscard]] Float4 sticking_force(const FrictionContact& contact, Float4 displacement) noexcept;

/// f - P(f - scale (u + mu |u_t| n)) with the projection P onto the cone: zero just where the law holds, N (De Saxce &
/// Feng 1998). For the loop, constant work.
[[nodiscard]] Float4 natural_map(const FrictionContact& contact, Float4 displacement, Float4 force) noexcept;

/// By force alone: whether it is there, and whether it lies on the cone. For the loop, constant work.
[[nodiscard]] ContactState contact_state(const FrictionContact& contact, Float4 force) noexcept;

}  // namespace greenloop
