#include "sim_hw/device/haptic_device.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "sim_hw/device/encoder.hpp"

namespace greenloop {

Coupling coupling(const layout::Info& info, const BodySurface& surface, const ProbeSize& probe,
                  const HandParameters& hand) {
  Coupling result;
  result.motion_scale = (0.5 * surface.diagonal + 2 * probe.radius) / Coupling::reach;
  const double depth = 2.0 / 3.0 * probe.depth;
  const double modulus = info.young / (1 - info.poisson * info.poisson);
  const double body_force = 4.0 / 3.0 * modulus * std::sqrt(probe.radius * depth) * depth;
  const double hand_force = 0.5 * hand.stiffness * depth / result.motion_scale;
  result.force_scale = std::min(1.0, hand_force / body_force);
  return result;
}

Double3 Tilt::at(double time) const {
  const double share = time / seconds - std::floor(time / seconds);
  const double there = smoothstep(share < 0.5 ? 2 * share : 2 - 2 * share);
  const Double3 direction = unit((1 - there) * down + there * to_the_side);
  return norm(down) * direction;
}

HapticDevice::HapticDevice(DeviceSetup setup) : setup_(std::move(setup)), arrival_(setup_.faults), tank_(setup_.tank) {
  for (std::size_t p = 0; p < setup_.motion.size(); ++p) hands_.emplace_back(setup_.hand, handle_target(p, 0));
  motor_force_.resize(hands_.size());
  rendering_.resize(static_cast<std::size_t>(setup_.delay) + 1, {motor_force_, 0});
  state_.num_tools = static_cast<std::uint32_t>(hands_.size());
  state_.resolution = Coupling::resolution * setup_.coupling.motion_scale;
  state_.origin[0] = setup_.origin.x;
  state_.origin[1] = setup_.origin.y;
  state_.origin[2] = setup_.origin.z;
  measure();
}

void HapticDevice::apply(const LoopCommand& command) {
  const std::int64_t cycle = state_.cycle;
  summary_.digest = command.digest;
  summary_.late_injected += arrival_.injected(cycle);
  if (!arrival_.late(cycle, command.work, command.budget)) receive(command);
  render();
  move();
  ++summary_.cycles;
  summary_.late = arrival_.late_count();
  summary_.stopped = arrival_.must_stop();
  state_.cycle = cycle + 1;
  measure();
}

/// Into what is under way at its end.
void HapticDevice::receive(const LoopCommand& command) {
  Rendering& last = rendering_.back();
  for (std::size_t p = 0; p < hands_.size(); ++p) {
    const double(&force)[3] = command.tools[p].force;
    last.force[p] = setup_.coupling.force_scale * Double3{force[0], force[1], force[2]};
  }
  last.stored = setup_.coupling.energy_scale() * command.stored;
}

void HapticDevice::render() {
  std::array<Double3, max_tools> handle;
  for (std::size_t p = 0; p < hands_.size(); ++p) {
    handle[p] = encoder_value(state_.tools[p].position, Coupling::resolution);
  }
  motor_force_ = rendering_.front().force;
  tank_.step(std::span(handle).first(hands_.size()), motor_force_, rendering_.front().stored);
  summary_.overdrawn = 0 - tank_.lowest();
  summary_.drained = tank_.drained();
  if (rendering_.size() > 1) {
    rendering_.pop_front();
    rendering_.push_back(rendering_.back());
  }
}

void HapticDevice::move() {
  const double time = static_cast<double>(state_.cycle) * setup_.period;
  for (std::size_t p = 0; p < hands_.size(); ++p) {
    const HandTarget target{handle_target(p, time), handle_target(p, time + 0.5 * setup_.period),
                            handle_target(p, time + setup_.period)};
    const Double3 from = hands_[p].position();
    hands_[p].advance(target, motor_force_[p], setup_.period);
    summary_.delivered += dot(motor_force_[p], hands_[p].position() - from);
  }
  summary_.delivered_most = std::max(summary_.delivered_most, summary_.delivered);
}

void HapticDevice::measure() {
  const double time = static_cast<double>(state_.cycle) * setup_.period;
  for (std::size_t p = 0; p < hands_.size(); ++p) {
    const Double3 position = hands_[p].position();
    const double coordinate[3] = {position.x, position.y, position.z};
    const ProbeTarget target = setup_.motion[p].target(time);
    for (int i = 0; i < 3; ++i) {
      state_.tools[p].position[i] = encoder_counts(coordinate[i], Coupling::resolution);
    }
    for (int i = 0; i < 4; ++i) {
      state_.tools[p].orientation[i] =
          static_cast<std::int16_t>(encoder_counts(target.quaternion[i] * ToolState::unit, 1));
    }
  }
  state_.impulse = setup_.impulses.next(state_.cycle);
  const Double3 gravity = setup_.gravity.at(time);
  state_.gravity[0] = gravity.x;
  state_.gravity[1] = gravity.y;
  state_.gravity[2] = gravity.z;
}

Double3 HapticDevice::handle_target(std::size_t probe, double time) const {
  return (1 / setup_.coupling.motion_scale) * (setup_.motion[probe].target(time).centre - setup_.origin);
}

}  // namespace greenloop
