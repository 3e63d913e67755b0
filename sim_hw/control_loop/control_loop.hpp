#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "runtime/algebra/fnv1a.hpp"
#include "runtime/contact_body.hpp"
#include "sim_hw/messages/device_state.hpp"
#include "sim_hw/messages/loop_command.hpp"

namespace greenloop {

struct LoopSetup {
  double probe_radius = 0;          ///< m, > 0: the tools are balls
  double friction = 0.3;            ///< Coulomb's coefficient of the tools, 0 or more
  bool gravity = false;             ///< what the device says of it acts on the body
  Budget budget;                    ///< of every cycle, as ContactBody::step has it
  std::int64_t field_every = 1;     ///< the displacement of the whole body is rendered in every so-manieth cycle
  std::int64_t overrun_cycle = -1;  ///< negative control: this cycle spends more than its budget; -1: none does
};

/// The loop proper: what happens between the newest state of the device and the command that answers it.
/// cycle() and answer() use no heap, lock, system call, exception or clock.
class ControlLoop {
 public:
  /// `body` must outlive the loop.
  ControlLoop(ContactBody& body, const LoopSetup& setup) : body_(&body), setup_(setup) {}

  /// Touches the body with the tools where the device says they are. A state that is not finite is refused like a
  /// contact that is not: held_not_finite, and the last good force stays.
  void cycle(const DeviceState& state) noexcept;

  /// Writes the answer to the last cycle and adds its response to the digest.
  void answer(LoopCommand& command) noexcept;

  [[nodiscard]] const ContactBody::StepReport& report() const noexcept { return report_; }
  [[nodiscard]] std::span<const ContactBody::ToolInput> tools() const noexcept { return {tool_.data(), tool_count_}; }
  /// What the tools feel, as of the last cycle that was answered.
  [[nodiscard]] std::span<const ContactBody::ToolAnswer> answers() const noexcept { return body_->tools(); }
  [[nodiscard]] std::span<const ContactBody::Contact> contacts() const noexcept { return body_->contacts(); }
  /// Units that finding what touches the last cycle's tools takes at most.
  [[nodiscard]] std::uint64_t touching_bound() const noexcept { return body_->touching_work(tools()); }
  [[nodiscard]] const ContactBody::Energy& energy() const noexcept { return body_->energy(); }
  /// [nodes] m, as of the last cycle that was answered.
  [[nodiscard]] std::span<const Vec4> field() const noexcept { return body_->displacement(); }
  [[nodiscard]] bool field_is_new() const noexcept { return field_is_new_; }
  [[nodiscard]] const LoopSetup& setup() const noexcept { return setup_; }

 private:
  [[nodiscard]] bool read(const DeviceState& state) noexcept;
  void overrun() noexcept;

  ContactBody* body_;
  LoopSetup setup_;
  std::array<ContactBody::ToolInput, max_tools> tool_{};
  std::size_t tool_count_ = 0;
  Elastostatic::Loads loads_;
  std::int64_t cycle_ = 0;
  bool field_is_new_ = false;
  ContactBody::StepReport report_;
  Fnv1a digest_;
};

}  // namespace greenloop
