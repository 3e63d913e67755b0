#include "runtime/friction/energy.hpp"

#include <algorithm>
#include <cfloat>
#include <cmath>

#include "runtime/algebra/double3.hpp"

namespace greenloop {
namespace {

Double3 wide(const Vec4& v) { return {v.x, v.y, v.z}; }
Double3 wide(const Vec3& v) { return {v.x, v.y, v.z}; }
Vec3 narrow(const Double3& v) { return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)}; }

}  // namespace

void EnergyAccount::add(std::span<const EnergyContact> contacts) noexcept {
  stored = 0;
  for (const EnergyContact& contact : contacts) {
    const Double3 force = wide(contact.force);
    const Double3 moved = wide(contact.shift) - wide(contact.last_shift);
    const Double3 slip = moved - wide(contact.way);
    const Double3 normal = wide(contact.normal);
    const double closed = -dot(force, normal) * dot(slip, normal);
    in += dot(force, wide(contact.way));
    stored += dot(force, wide(contact.shift)) / 2;
    dissipated -= dot(force, slip) + closed;
    lost += closed + dot(force - wide(contact.last_force), moved) / 2;
  }
}

double passive_stiffness(const SampledLoop& loop, double virtual_damping) noexcept {
  const double left = loop.damping - std::abs(virtual_damping);
  return left > 0 ? left / (loop.period / 2 + loop.delay) : 0;
}

double coupling_stiffness(double body, double limit) noexcept {
  return body <= limit ? DBL_MAX : body * limit / (body - limit);
}

Vec3 EnergyTank::step(const Vec3& position, const Vec3& force, double stored) noexcept {
  const Double3 moved = begun_ ? wide(position) - wide(position_) : Double3{};
  const double out = dot(wide(force_), moved);
  delivered_ += out;
  drained_ -= dot(wide(braking_), moved);
  level_ = std::min(level_ - out, std::max(stored, 0.0) + settings_.reserve);
  // the next motion will be about the last
  const double excess = dot(wide(force), moved) - level_;
  const double square = dot(moved, moved);
  const double damping = square > 0 ? std::min(excess / square, settings_.most_damping / settings_.period) : 0;
  const bool brakes = settings_.enabled && damping > 0;
  begun_ = true;
  position_ = position;
  braking_ = brakes ? narrow(-damping * moved) : Vec3{};
  force_ = narrow(wide(force) + wide(braking_));
  return force_;
}

}  // namespace greenloop
