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
  between_ = state.cycle % setup_.fast != 0;
  if (between_) {
    field_is_new_ = false;
    return follow();
  }
  const bool starves = setup_.starved.work > 0 && state.cycle / 1000 % 4 == 3;
  budget_ = starves ? setup_.starved : setup_.budget;
  field_is_new_ = state.cycle / setup_.fast % setup_.field_every == 0;
  if (state.cycle == setup_.overrun_cycle) {
    overrun();
  } else {
    report_ = step(budget_);
  }
  keep();
}

/// Of the body, and of its motions if it has some; work of both.
ContactBody::StepReport ControlLoop::step(Budget budget) noexcept {
  if (setup_.vibrating == nullptr) return body_->step(tools(), loads_, budget);
  VibratingBody::StepReport report = setup_.vibrating->step(impulse_, tools(), loads_, budget);
  motion_ = report.motion;
  report.contact.work = report.work;
  return report.contact;
}

/// What the cycles until the next step go by.
void ControlLoop::keep() noexcept {
  for (std::size_t t = 0; t < answers().size(); ++t) felt_[t] = {answers()[t].force, answers()[t].torque};
  if (setup_.fast == 1) return;
  local_work_ = body_->local_model(false, static_cast<float>(setup_.probe_radius), local_);
  if (local_work_ == 0) local_.tools = 0;
  for (std::size_t t = 0; t < tool_count_; ++t) stepped_at_[t] = tool_[t].tool.pose.position;
}

/// Between two steps. Where a step was refused, what was felt stays.
void ControlLoop::follow() noexcept {
  report_.work = report_.touching_work = 0;
  if (local_.tools == 0 || local_.tools != tool_count_) return;
  std::array<float, LocalModel::most_components> motion{}, wrench{};
  for (std::size_t t = 0; t < tool_count_; ++t) {
    const Double3 moved = tool_[t].tool.pose.position - stepped_at_[t];
    motion[3 * t] = static_cast<float>(moved.x);
    motion[3 * t + 1] = static_cast<float>(moved.y);
    motion[3 * t + 2] = static_cast<float>(moved.z);
  }
  const std::span<const float> all = std::span(motion).first(3 * tool_count_);
  local_.evaluate(all, std::span(wrench).first(6 * tool_count_));
  in_range_ = local_.motion_length(all) <= local_.range;
  for (std::size_t t = 0; t < tool_count_; ++t) {
    const float* const w = wrench.data() + 6 * t;
    const float* const at_step = local_.wrench + 6 * t;
    const Double3 force{w[0], w[1], w[2]};
    const bool pulls = dot(force, {at_step[0], at_step[1], at_step[2]}) <= 0;
    felt_[t] = pulls ? Wrench{} : Wrench{force, {w[3], w[4], w[5]}};
  }
}

void ControlLoop::refer() noexcept {
  if (setup_.reference != nullptr) setup_.reference->step(tools(), loads_, setup_.budget);
}

/// False, with the tools as they were, if a number is not finite.
bool ControlLoop::read(const DeviceState& state) noexcept {
  cycle_ = state.cycle;
  impulse_ = static_cast<std::uint32_t>(state.impulse);  // -1 is no_impulse
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
    tool.compliance = setup_.compliance;
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
    report_ = step(unlimited);
    work += std::max<std::uint64_t>(report_.work, 1);
  } while (work <= budget_.work);
  report_.work = work;
}

void ControlLoop::answer(LoopCommand& command) noexcept {
  if (between_) {
    digest_.add(std::as_bytes(std::span(felt_).first(tool_count_)));
  } else {
    for (const ContactBody::Contact& contact : contacts()) digest_.add(std::as_bytes(std::span(&contact.force, 1)));
  }
  if (field_is_new_) digest_.add(std::as_bytes(field()));
  command.cycle = cycle_;
  command.work = static_cast<std::int64_t>(report_.work);
  command.budget = static_cast<std::int64_t>(budget_.work);
  command.level = static_cast<std::int32_t>(report_.constraint_level);
  command.field_level = static_cast<std::int32_t>(report_.field_level);
  command.status = static_cast<std::int32_t>(report_.status);
  command.digest = static_cast<std::int64_t>(digest_.value());
  command.num_tools = static_cast<std::uint32_t>(tool_count_);
  for (std::size_t t = 0; t < tool_count_; ++t) {
    put(command.tools[t].force, felt_[t].force);
    put(command.tools[t].torque, felt_[t].torque);
  }
  command.stored = energy().stored;
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
