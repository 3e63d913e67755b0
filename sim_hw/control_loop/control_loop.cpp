#include "sim_hw/control_loop/control_loop.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim_hw/device/encoder.hpp"

namespace greenloop {
namespace {

constexpr double largest_place = 1e12;  // m, and m per count: farther than any body, and its squares are finite

}  // namespace

ControlLoop::ControlLoop(LoopBody& body, const BodySurface& surface, const LoopSetup& setup)
    : body_(&body), setup_(setup), touchable_(surface.touchable_nodes()) {
  const SurfaceNodes nodes{surface.position, surface.normal, touchable_};
  const SphereContacts::Limits limits{.radius = setup.probe_radius, .max_contacts = setup.max_contacts};
  contact_memory_ = AlignedBytes(SphereContacts::required(nodes, limits));
  sphere_contacts_ = SphereContacts::create(nodes, limits, {contact_memory_.data(), contact_memory_.size()}).contacts;
}

void ControlLoop::cycle(const DeviceState& state) noexcept {
  if (!read(state)) {
    field_is_new_ = false;
    report_.status = Status::held_not_finite;
    report_.work = 0;
    return;
  }
  contacts_ = sphere_contacts_.find(probes(), field());
  step(state.cycle);
  if (!answered(report_.status)) return;  // the hands feel the last good force
  sphere_contacts_.settle(probes(), body_->force());
  sum_hand_force();
}

/// False, with the probes as they were, if a place is not finite.
bool ControlLoop::read(const DeviceState& state) noexcept {
  cycle_ = state.cycle;
  const double scale = norm({state.origin[0], state.origin[1], state.origin[2]}) + std::abs(state.resolution);
  if (!(scale < largest_place)) return false;
  probe_count_ = std::min(state.num_tools, max_tools);
  const Double3 origin{state.origin[0], state.origin[1], state.origin[2]};
  for (std::size_t p = 0; p < probe_count_; ++p) {
    probe_[p].centre = origin + encoder_value(state.tools[p].position, state.resolution);
    const std::int16_t(&axis)[3] = state.tools[p].axis;
    probe_[p].axis = unit({static_cast<double>(axis[0]), static_cast<double>(axis[1]), static_cast<double>(axis[2])});
  }
  return true;
}

void ControlLoop::step(std::int64_t cycle) noexcept {
  field_is_new_ = cycle % setup_.field_every == 0;
  if (cycle == setup_.overrun_cycle) {
    overrun();
  } else {
    report_ = body_->step(contacts_, setup_.budget.work, field_is_new_);
  }
}

/// Repeats the step without a limit until more than the budget is spent.
void ControlLoop::overrun() noexcept {
  constexpr std::uint64_t unlimited = std::numeric_limits<std::uint64_t>::max();
  std::uint64_t work = 0;
  do {
    report_ = body_->step(contacts_, unlimited, field_is_new_);
    work += std::max<std::uint64_t>(report_.work, 1);
  } while (work <= setup_.budget.work);
  report_.work = work;
}

void ControlLoop::sum_hand_force() noexcept {
  hand_force_ = {};
  const auto force = body_->force();
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    hand_force_[sphere_contacts_.holder(i)] += -Double3{force[3 * i], force[3 * i + 1], force[3 * i + 2]};
  }
}

void ControlLoop::answer(LoopCommand& command) noexcept {
  const auto force = body_->force();
  digest_.add(std::as_bytes(force));
  if (field_is_new_) digest_.add(std::as_bytes(field()));
  command.cycle = cycle_;
  command.work = static_cast<std::int64_t>(report_.work);
  command.budget = static_cast<std::int64_t>(setup_.budget.work);
  command.level = static_cast<std::int32_t>(report_.constraint_level);
  command.field_level = static_cast<std::int32_t>(report_.field_level);
  command.status = static_cast<std::int32_t>(report_.status);
  command.digest = static_cast<std::int64_t>(digest_.value());
  command.num_tools = static_cast<std::uint32_t>(probe_count_);
  for (std::size_t p = 0; p < probe_count_; ++p) {
    const Double3& force_on_hand = hand_force_[p];
    command.tool_force[p][0] = force_on_hand.x;
    command.tool_force[p][1] = force_on_hand.y;
    command.tool_force[p][2] = force_on_hand.z;
  }
  command.num_contacts = static_cast<std::uint32_t>(contacts_.size());
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    command.contacts[i].node = contacts_[i].node;
    std::copy_n(&force[3 * i], 3, command.contacts[i].force);
  }
}

}  // namespace greenloop
