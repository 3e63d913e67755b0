#include "runtime/friction/contact_newton.hpp"

#include <algorithm>
#include <cmath>

namespace greenloop {
namespace {

float dot(const Float4* a, const Float4* b, std::uint32_t count) {
  Float4 sum{};
  for (std::uint32_t i = 0; i < count; ++i) {
    sum += a[i] * b[i];
  }
  return (sum[0] + sum[1]) + sum[2];
}

// the contact as the natural map sees it; the force becomes one of that state
FrozenContact frozen(const FrictionContact& contact, float scale, Float4 displacement, Float4& force) {
  const Float4 moved = force - splat(scale) * displacement;
  const float normal = dot3(contact.normal, moved);
  if (!(normal > 0)) {
    force = Float4{};
    return {};
  }
  const Float4 tangent = moved - splat(normal) * contact.normal;
  const float size = std::sqrt(dot3(tangent, tangent));
  if (size <= contact.friction * normal) {
    return {ContactState::stick};
  }
  const Float4 along = splat(1 / size) * tangent;
  const Float4 push = contact.normal + splat(contact.friction) * along;
  const Float4 across = cross(contact.normal, along);
  const float pressed = std::max(dot3(contact.normal, force), 0.0F);
  force = splat(pressed) * push + splat(dot3(across, force)) * across;
  const float sliding = std::min(contact.friction * pressed / size, 1.0F);
  return {ContactState::slip, push, across, sliding, (1 - sliding) / scale};
}

// what the frozen law makes of a change of displacement and of force; zero where it holds by the choice of the force
Float4 law(const FrictionContact& contact, const FrozenContact& of, Float4 displacement, Float4 force) {
  if (of.state == ContactState::open) {
    return Float4{};
  }
  if (of.state == ContactState::stick) {
    return displacement;
  }
  const float across = of.sliding * dot3(of.across, displacement) + of.holding * dot3(of.across, force);
  return splat(dot3(contact.normal, displacement)) * contact.normal + splat(across) * of.across;
}

// the force of one contact alone with which its law is `value`
Float4 local_solution(const FrictionContact& contact, const FrozenContact& of, const Block<3>& compliance,
                      Float4 value) {
  if (of.state == ContactState::open) {
    return Float4{};
  }
  if (of.state == ContactState::stick) {
    return sticking_force(contact, value);
  }
  const Float4 by_push = law(contact, of, product(compliance, of.push), of.push);
  const Float4 by_across = law(contact, of, product(compliance, of.across), of.across);
  const float nn = dot3(contact.normal, by_push);
  const float na = dot3(contact.normal, by_across);
  const float an = dot3(of.across, by_push);
  const float aa = dot3(of.across, by_across);
  const float determinant = nn * aa - na * an;
  const float n = dot3(contact.normal, value);
  const float a = dot3(of.across, value);
  const float inverse = determinant > 0 ? 1 / determinant : 0;
  return splat((n * aa - na * a) * inverse) * of.push + splat((nn * a - an * n) * inverse) * of.across;
}

}  // namespace

/// The least-squares problem of GMRES, kept triangular by Givens' rotations.
struct ContactNewton::Triangle {
  static constexpr std::uint32_t most = most_vectors;
  float column[most][most + 1];
  float right[most + 1];
  float cosine[most], sine[most];

  // rotates column k, of k + 2 entries; false if it is zero
  bool rotate(std::uint32_t k) {
    float* const c = column[k];
    for (std::uint32_t j = 0; j < k; ++j) {
      const float upper = c[j];
      c[j] = cosine[j] * upper + sine[j] * c[j + 1];
      c[j + 1] = cosine[j] * c[j + 1] - sine[j] * upper;
    }
    const float length = std::sqrt(c[k] * c[k] + c[k + 1] * c[k + 1]);
    if (!(length > 0)) {
      return false;
    }
    cosine[k] = c[k] / length;
    sine[k] = c[k + 1] / length;
    c[k] = length;
    right[k + 1] = -sine[k] * right[k];
    right[k] *= cosine[k];
    return true;
  }

  // the solution in place of the right side
  void solve(std::uint32_t order) {
    for (std::uint32_t i = order; i-- > 0;) {
      for (std::uint32_t j = i + 1; j < order; ++j) {
        right[i] -= column[j][i] * right[j];
      }
      right[i] /= column[i][i];
    }
  }
};

void displace(const ContactPoints& points, const Float4* force, Float4* displacement) noexcept {
  multiply(points.compliance, points.count, force, displacement);
  for (std::uint32_t i = 0; i < points.count; ++i) {
    displacement[i] += points.gap[i];
  }
}

void ContactNewton::carve(Arena& arena, std::uint32_t candidates) noexcept {
  frozen_ = arena.take<FrozenContact>(candidates);
  triangle_ = arena.take<Triangle>(1);
  start_force_ = arena.take<Float4>(candidates);
  start_displacement_ = arena.take<Float4>(candidates);
  direction_ = arena.take<Float4>(candidates);
  for (Float4*& vector : vector_) {
    vector = arena.take<Float4>(candidates);
  }
}

// vector k + 1 of the subspace, before it has unit length: returns that
float ContactNewton::expand(const ContactPoints& points, std::uint32_t k, float* products) noexcept {
  Float4* const next = vector_[k + 1];
  for (std::uint32_t i = 0; i < points.count; ++i) {
    direction_[i] = local_solution(points.contact[i], frozen_[i], points.compliance.at(i, i), vector_[k][i]);
  }
  multiply(points.compliance, points.count, direction_, next);
  for (std::uint32_t i = 0; i < points.count; ++i) {
    next[i] = law(points.contact[i], frozen_[i], next[i], direction_[i]);
  }
  for (std::uint32_t j = 0; j <= k; ++j) {
    products[j] = dot(next, vector_[j], points.count);
    for (std::uint32_t i = 0; i < points.count; ++i) {
      next[i] -= splat(products[j]) * vector_[j][i];
    }
  }
  return products[k + 1] = std::sqrt(dot(next, next, points.count));
}

// of the frozen system whose right side is the first vector
std::uint32_t ContactNewton::add_solution(const ContactPoints& points, const Terms& terms, Float4* force) noexcept {
  Triangle& triangle = *triangle_;
  const float begun = std::sqrt(dot(vector_[0], vector_[0], points.count));
  triangle.right[0] = begun;
  std::uint32_t used = 0;
  for (float length = begun; used < terms.vectors && length > 0;) {
    const float inverse = 1 / length;
    for (std::uint32_t i = 0; i < points.count; ++i) {
      vector_[used][i] *= splat(inverse);
    }
    length = expand(points, used, triangle.column[used]);
    if (!triangle.rotate(used)) break;
    ++used;
    if (std::fabs(triangle.right[used]) <= terms.reduction * begun) break;
  }
  triangle.solve(used);
  for (std::uint32_t i = 0; i < points.count; ++i) {
    Float4 value{};
    for (std::uint32_t k = 0; k < used; ++k) {
      value += splat(triangle.right[k]) * vector_[k][i];
    }
    force[i] += local_solution(points.contact[i], frozen_[i], points.compliance.at(i, i), value);
  }
  return used;
}

// square of the natural map at a part of the way from the start
float ContactNewton::squared_residual(const ContactPoints& points, float part, const Float4* force,
                                      const Float4* displacement) const noexcept {
  float sum = 0;
  for (std::uint32_t i = 0; i < points.count; ++i) {
    const Float4 f = start_force_[i] + splat(part) * (force[i] - start_force_[i]);
    const Float4 u = start_displacement_[i] + splat(part) * (displacement[i] - start_displacement_[i]);
    const Float4 map = natural_map(points.contact[i], u, f);
    sum += dot3(map, map);
  }
  return sum;
}

// goes that part of the way at whose end the natural map is smallest
void ContactNewton::search(const ContactPoints& points, Float4* force, Float4* displacement) noexcept {
  float best = 1;
  float least = squared_residual(points, 1, force, displacement);
  for (float part = 0.5F; part >= 0.125F; part /= 2) {
    const float here = squared_residual(points, part, force, displacement);
    if (here < least) {
      least = here;
      best = part;
    }
  }
  for (std::uint32_t i = 0; i < points.count; ++i) {
    force[i] = start_force_[i] + splat(best) * (force[i] - start_force_[i]);
    displacement[i] = start_displacement_[i] + splat(best) * (displacement[i] - start_displacement_[i]);
  }
}

std::uint32_t ContactNewton::step(const ContactPoints& points, const Terms& terms, Float4* force,
                                  Float4* displacement) noexcept {
  for (std::uint32_t i = 0; i < points.count; ++i) {
    start_force_[i] = force[i];
    start_displacement_[i] = displacement[i];
    frozen_[i] = frozen(points.contact[i], terms.weight * points.contact[i].scale, displacement[i], force[i]);
  }
  displace(points, force, displacement);
  for (std::uint32_t i = 0; i < points.count; ++i) {
    vector_[0][i] = -law(points.contact[i], frozen_[i], displacement[i], force[i]);
  }
  const std::uint32_t used = add_solution(points, terms, force);
  displace(points, force, displacement);
  search(points, force, displacement);
  return used;
}

void ContactNewton::linearise(const ContactPoints& points, const Float4* force, const Float4* displacement) noexcept {
  for (std::uint32_t i = 0; i < points.count; ++i) {
    Float4 as_frozen = force[i];
    frozen_[i] = frozen(points.contact[i], points.contact[i].scale, displacement[i], as_frozen);
  }
}

std::uint32_t ContactNewton::respond(const ContactPoints& points, const Terms& terms, Float4* displacement,
                                     Float4* force) noexcept {
  for (std::uint32_t i = 0; i < points.count; ++i) {
    force[i] = Float4{};
    vector_[0][i] = -law(points.contact[i], frozen_[i], displacement[i], force[i]);
  }
  const std::uint32_t used = add_solution(points, terms, force);
  multiply(points.compliance, points.count, force, direction_);
  for (std::uint32_t i = 0; i < points.count; ++i) {
    displacement[i] += direction_[i];
  }
  return used;
}

}  // namespace greenloop
