#include "runtime/passivity.hpp"

#include <algorithm>
#include <cfloat>
#include <cmath>

namespace greenloop {
namespace {

bool all_finite(std::span<const Double3> position, std::span<const Double3> force, double stored) {
  double sum = stored;
  for (std::size_t p = 0; p < force.size(); ++p) sum += dot(position[p], position[p]) + dot(force[p], force[p]);
  return std::isfinite(sum);
}

}  // namespace

double passive_stiffness(const SampledLoop& loop, double virtual_damping) noexcept {
  const double left = loop.damping - std::abs(virtual_damping);
  return left > 0 ? left / (loop.period / 2 + loop.delay) : 0;
}

double coupling_stiffness(double body, double limit) noexcept {
  return body <= limit ? DBL_MAX : body * limit / (body - limit);
}

void EnergyTank::step(std::span<const Double3> position, std::span<Double3> force, double stored) noexcept {
  const std::size_t ports = std::min<std::size_t>({position.size(), force.size(), most_ports});
  if (!all_finite(position.first(ports), force.first(ports), stored)) {
    for (Double3& each : force) each = {};
    ports_ = 0;
    return;
  }
  std::array<Double3, most_ports> moved;
  double out = 0, wanted = 0, square = 0;
  for (std::size_t p = 0; p < ports; ++p) {
    moved[p] = p < ports_ ? position[p] - position_[p] : Double3{};
    if (p < ports_) {
      out += dot(force_[p], moved[p]);
      drained_ -= dot(braking_[p], moved[p]);
    }
    wanted += dot(force[p], moved[p]);
    square += dot(moved[p], moved[p]);
  }
  delivered_ += out;
  level_ = std::min(level_ - out, std::max(stored, 0.0) + settings_.reserve);
  lowest_ = std::min(lowest_, level_);
  // the next motion will be about the last
  const double excess = wanted - level_;
  const double damping = square > 0 ? std::clamp(excess / square, 0.0, settings_.most_damping / settings_.period) : 0;
  for (std::size_t p = 0; p < ports; ++p) {
    braking_[p] = settings_.enabled ? -damping * moved[p] : Double3{};
    position_[p] = position[p];
    force[p] = force_[p] = force[p] + braking_[p];
  }
  ports_ = static_cast<std::uint32_t>(ports);
}

}  // namespace greenloop
