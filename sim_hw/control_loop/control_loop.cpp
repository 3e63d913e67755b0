#include "sim_hw/control_loop/control_loop.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim_hw/device/encoder.hpp"

namespace greenloop {
namespace {

constexpr double largest_place = 1e12;  // m, and m per count: farther than any body, and its squares are finite

void put(double (&to)[3], const Double3& from) {
  to[0] = from.x;
  to[1] = from.y;
  to[2] = from.z;
}

}  // namespace

void ControlLoop::cycle(const DeviceState& state) noexcept {
  if (!read(state)) {
    field_is_new_ = false;
    report_.status = Status::held_not_finite;
    report_.work = 0;
    return;
  }
  field_is_new_ = state.cycle % setup_.field_every == 0;
  if (state.cycle == setup_.overrun_cycle) {
    overrun();
  } else {
    report_ = body_->step(tools(), loads_, setup_.budget);
  }
}

/// False, with the tools as they were, if a number is not finite.
bool ControlLoop::read(const DeviceState& state) noexcept {
  cycle_ = state.cycle;
  const double scale = norm({state.origin[0], state.origin[1], state.origin[2]}) + std::abs(state.resolution) +
                       norm({state.gravity[0], state.gravity[1], state.gravity[2]});
  if (!(scale < largest_place)) return false;
  tool_count_ = std::min(state.num_tools, max_tools);
  const Double3 origin{state.origin[0], state.origin[1], state.origin[2]};
  for (std::size_t t = 0; t < tool_count_; ++t) {
    const ToolState& measured = state.tools[t];
    ContactBody::ToolInput& tool = tool_[t];
    tool.tool.shape = Shape::sphere(setup_.probe_radius);
    tool.tool.pose.position = origin + encoder_value(measured.position, state.resolution);
    for (int i = 0; i < 4; ++i) {
      tool.tool.pose.quaternion[i] = static_cast<double>(measured.orientation[i]) / ToolState::unit;
    }
    tool.friction = setup_.friction;
  }
  if (setup_.gravity) {
    loads_.gravity = {static_cast<float>(state.gravity[0]), static_cast<float>(state.gravity[1]),
                      static_cast<float>(state.gravity[2])};
  }
  return true;
}

/// Repeats the step without a limit until more than the budget is spent.
void ControlLoop::overrun() noexcept {
  constexpr Budget unlimited{std::numeric_limits<std::uint64_t>::max() / 2};
  std::uint64_t work = 0;
  do {
    report_ = body_->step(tools(), loads_, unlimited);
    work += std::max<std::uint64_t>(report_.work, 1);
  } while (work <= setup_.budget.work);
  report_.work = work;
}

void ControlLoop::answer(LoopCommand& command) noexcept {
  for (const ContactBody::Contact& contact : contacts()) digest_.add(std::as_bytes(std::span(&contact.force, 1)));
  if (field_is_new_) digest_.add(std::as_bytes(field()));
  command.cycle = cycle_;
  command.work = static_cast<std::int64_t>(report_.work);
  command.budget = static_cast<std::int64_t>(setup_.budget.work);
  command.level = static_cast<std::int32_t>(report_.constraint_level);
  command.field_level = static_cast<std::int32_t>(report_.field_level);
  command.status = static_cast<std::int32_t>(report_.status);
  command.digest = static_cast<std::int64_t>(digest_.value());
  command.num_tools = static_cast<std::uint32_t>(tool_count_);
  for (std::size_t t = 0; t < tool_count_; ++t) {
    const bool known = t < answers().size();
    put(command.tools[t].force, known ? answers()[t].force : Double3{});
    put(command.tools[t].torque, known ? answers()[t].torque : Double3{});
  }
  command.num_contacts = static_cast<std::uint32_t>(std::min<std::size_t>(contacts().size(), command.max_contacts));
  for (std::size_t i = 0; i < command.num_contacts; ++i) {
    const ContactBody::Contact& contact = contacts()[i];
    ContactForce& force = command.contacts[i];
    force.node = contact.node[0];
    force.tool = static_cast<std::uint8_t>(contact.tool);
    force.state = static_cast<std::uint8_t>(contact.state);
    force.force[0] = static_cast<float>(contact.force.x);
    force.force[1] = static_cast<float>(contact.force.y);
    force.force[2] = static_cast<float>(contact.force.z);
  }
}

}  // namespace greenloop
