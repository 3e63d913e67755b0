#include "runtime/friction/friction.hpp"

#include <algorithm>
#include <cfloat>
#include <cmath>

namespace greenloop {
namespace {

constexpr int most_steps = 30;
constexpr float enough = 0x1p-20F;      // of a change of the multiplier
constexpr float rounding = 0x1p-21F;    // of a force in space, of its length
constexpr float least_normal = 1e-12F;  // N: of smaller forces the squares vanish, and none is left of them

// a unit vector perpendicular to n
Float4 perpendicular(Float4 n) {
  const float x = std::fabs(n[0]);
  const float y = std::fabs(n[1]);
  const float z = std::fabs(n[2]);
  const Float4 least = x <= y && x <= z ? Float4{1, 0, 0, 0} : y <= z ? Float4{0, 1, 0, 0} : Float4{0, 0, 1, 0};
  const Float4 across = least - splat(dot3(least, n)) * n;
  return scaled(1 / std::sqrt(dot3(across, across)), across);
}

struct Principal {
  float value[2];
  float cosine, sine;  ///< of the first axis
};

// of the symmetric matrix [a b; b d]
Principal principal(float a, float b, float d) {
  const float mean = (a + d) / 2;
  const float half = (a - d) / 2;
  const float radius = std::sqrt(half * half + b * b);
  const float x = half >= 0 ? half + radius : b;
  const float y = half >= 0 ? b : radius - half;
  const float length = std::sqrt(x * x + y * y);
  const bool isotropic = !(length > 0);
  return {{mean + radius, mean - radius}, isotropic ? 1 : x / length, isotropic ? 0 : y / length};
}

// a force by its components
struct Components {
  float normal;
  float tangent[2];
};

Components force_of(const FrictionContact& contact, Float4 free, const float (&tangent)[2]) {
  const float taken = contact.coupling[0] * tangent[0] + contact.coupling[1] * tangent[1];
  return {-contact.stiffness * dot3(contact.normal, free) - taken, {tangent[0], tangent[1]}};
}

float length(const float (&tangent)[2]) { return std::sqrt(tangent[0] * tangent[0] + tangent[1] * tangent[1]); }

Float4 combined(const FrictionContact& contact, const Components& force, float share) {
  return splat(force.normal) * contact.normal +
         (splat(share * force.tangent[0]) * contact.tangent[0] + splat(share * force.tangent[1]) * contact.tangent[1]);
}

// of a friction coefficient: in space a friction force is rounded, and not quite perpendicular to the normal
float slack(float mu) { return rounding + std::min(rounding * mu * mu, mu / 8); }

// the part of a friction force that is left when it is shortened so that rounding does not lead out of the cone
float share_in_cone(const FrictionContact& contact, float normal, float friction) {
  const float most = (contact.friction - slack(contact.friction)) * normal;
  return friction <= most ? 1 : most > 0 ? most / friction : 0;
}

Float4 in_space(const FrictionContact& contact, const Components& force) {
  return force.normal > least_normal
             ? combined(contact, force, share_in_cone(contact, force.normal, length(force.tangent)))
             : Float4{};
}

// slipping: the friction force at a multiplier x is -p / (compliance + x), component by component; it and the normal
// force are such that their ratio is mu
struct Slip {
  const FrictionContact& contact;
  Float4 free;
  float p[2];

  Slip(const FrictionContact& of, Float4 displacement) : contact(of), free(displacement) {
    const float gap = dot3(of.normal, free);
    p[0] = dot3(of.tangent[0], free) - of.coupling[0] * gap;
    p[1] = dot3(of.tangent[1], free) - of.coupling[1] * gap;
  }

  [[nodiscard]] Components at(float x) const {
    return force_of(contact, free, {-p[0] / (contact.compliance[0] + x), -p[1] / (contact.compliance[1] + x)});
  }

  // mu normal / |t| - 1 grows with x, nearly linearly; its value and derivative
  struct Excess {
    float value, slope;
  };
  [[nodiscard]] Excess excess(float x, const Components& force) const {
    const float change[2] = {-force.tangent[0] / (contact.compliance[0] + x),
                             -force.tangent[1] / (contact.compliance[1] + x)};
    const float friction = length(force.tangent);
    const float ratio = contact.friction * force.normal / friction;
    const float shorter = (force.tangent[0] * change[0] + force.tangent[1] * change[1]) / friction;
    const float taken = contact.coupling[0] * change[0] + contact.coupling[1] * change[1];
    return {ratio - 1, (-contact.friction * taken - ratio * shorter) / friction};
  }
};

// Newton's steps between bounds, which halve the way where a step leaves them
Components slipping(const Slip& slip, float& multiplier) {
  float low = 0;
  float high = FLT_MAX;
  float x = multiplier;
  Components force = slip.at(x);
  for (int step = 0; step < most_steps; ++step) {
    const Slip::Excess excess = slip.excess(x, force);
    (excess.value < 0 ? low : high) = x;
    const float newton = x - excess.value / excess.slope;
    const float middle = high < FLT_MAX ? (low + high) / 2 : 2 * (x + slip.contact.compliance[0]);
    const float next = newton >= low && newton <= high ? newton : middle;
    const bool done = std::fabs(next - x) <= enough * (next + slip.contact.compliance[0]);
    x = next;
    force = slip.at(x);
    if (done) break;
  }
  multiplier = x;
  return force;
}

}  // namespace

bool set_friction_contact(Float4 normal, float friction, const Block<3>& compliance,
                          FrictionContact& contact) noexcept {
  const Float4 first = perpendicular(normal);
  const Float4 second = cross(normal, first);
  const Float4 of_normal = product(compliance, normal);
  const Float4 of_first = product(compliance, first);
  const float nn = dot3(normal, of_normal);
  const float n1 = dot3(first, of_normal);
  const float n2 = dot3(second, of_normal);
  const float stiffness = 1 / nn;
  const float tt = dot3(second, product(compliance, second));
  const float s11 = dot3(first, of_first) - n1 * n1 * stiffness;
  const float s12 = dot3(second, of_first) - n1 * n2 * stiffness;
  const float s22 = tt - n2 * n2 * stiffness;
  const Principal axes = principal(s11, s12, s22);
  contact.normal = normal;
  contact.tangent[0] = splat(axes.cosine) * first + splat(axes.sine) * second;
  contact.tangent[1] = splat(axes.cosine) * second - splat(axes.sine) * first;
  contact.friction = friction < most_friction ? friction : most_friction;
  contact.stiffness = stiffness;
  contact.coupling[0] = (axes.cosine * n1 + axes.sine * n2) * stiffness;
  contact.coupling[1] = (axes.cosine * n2 - axes.sine * n1) * stiffness;
  contact.compliance[0] = axes.value[0];
  contact.compliance[1] = axes.value[1];
  contact.scale = 3 / (nn + dot3(first, of_first) + tt);
  return nn > 0 && stiffness <= FLT_MAX && axes.value[1] > 0 && axes.value[0] <= FLT_MAX && friction >= 0 &&
         friction <= FLT_MAX;
}

Float4 cone_projection(const FrictionContact& contact, Float4 force) noexcept {
  const float normal = dot3(contact.normal, force);
  const Float4 tangent = force - splat(normal) * contact.normal;
  const float friction = std::sqrt(dot3(tangent, tangent));
  const float mu = contact.friction;
  if (normal >= 0 && friction <= mu * normal) {
    return force;
  }
  if (mu * friction <= -normal) {
    return Float4{};
  }
  const float nearest = (normal + mu * friction) / (1 + mu * mu);
  return splat(nearest) * contact.normal + splat(mu * nearest / friction) * tangent;
}

Float4 force_in_cone(const FrictionContact& contact, Float4 force) noexcept {
  const Float4 nearest = cone_projection(contact, force);
  const float normal = dot3(contact.normal, nearest);
  const Float4 tangent = nearest - splat(normal) * contact.normal;
  const float share = share_in_cone(contact, normal, std::sqrt(dot3(tangent, tangent)));
  return normal > least_normal ? splat(normal) * contact.normal + splat(share) * tangent : Float4{};
}

Float4 local_force(const FrictionContact& contact, Float4 free, float& multiplier) noexcept {
  const float gap = dot3(contact.normal, free);
  if (!(gap < 0)) {
    return Float4{};
  }
  if (!(contact.friction > 0)) {
    return splat(-contact.stiffness * gap) * contact.normal;
  }
  const Slip slip(contact, free);
  const Components sticking = slip.at(0);
  if (length(sticking.tangent) <= contact.friction * sticking.normal) {
    multiplier = 0;
    return in_space(contact, sticking);
  }
  return in_space(contact, slipping(slip, multiplier));
}

Float4 sticking_force(const FrictionContact& contact, Float4 displacement) noexcept {
  return -combined(contact, Slip(contact, displacement).at(0), 1);
}

Float4 natural_map(const FrictionContact& contact, Float4 displacement, Float4 force) noexcept {
  const float gap = dot3(contact.normal, displacement);
  if (has_vectors && gap >= 0 && dot3(force, force) == 0) return Float4{};
  const Float4 tangent = displacement - splat(gap) * contact.normal;
  const float lifted = contact.friction * std::sqrt(dot3(tangent, tangent));
  const Float4 moved = displacement + splat(lifted) * contact.normal;
  return force - cone_projection(contact, force - splat(contact.scale) * moved);
}

ContactState contact_state(const FrictionContact& contact, Float4 force) noexcept {
  const float normal = dot3(contact.normal, force);
  if (!(normal > 0)) {
    return ContactState::open;
  }
  const Float4 tangent = force - splat(normal) * contact.normal;
  const float inside = (contact.friction - 4 * slack(contact.friction)) * normal;
  return inside > 0 && dot3(tangent, tangent) < inside * inside ? ContactState::stick : ContactState::slip;
}

}  // namespace greenloop
