#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "runtime/algebra/fnv1a.hpp"
#include "runtime/contact_body.hpp"
#include "runtime/vibrating_body.hpp"
#include "sim_hw/messages/device_state.hpp"
#include "sim_hw/messages/loop_command.hpp"

namespace greenloop {

struct LoopSetup {
  double probe_radius = 0;  ///< m, > 0: the tools are balls
  double friction = 0.3;    ///< Coulomb's coefficient of the tools, 0 or more
  double compliance = 0;    ///< m/N, of a virtual coupling between the hands and the tools; 0: there is none
  bool gravity = false;     ///< what the device says of it acts on the body
  Budget budget;            ///< of every cycle, as ContactBody::step has it
  Budget starved{};         ///< of every fourth thousand cycles instead; 0: they are as the others
  std::int64_t fast = 1;    ///< the body is stepped in every so-manieth cycle; in the others its local model is
                            ///< evaluated, of at most LocalModel::most_tools tools
  VibratingBody* vibrating = nullptr;  ///< that the body is the contacts of, which is then given the impulses, too
  ContactBody* reference = nullptr;    ///< another body, which refer() steps in every cycle
  std::int64_t field_every = 1;        ///< the displacement of the whole body is rendered in every so-manieth cycle
  std::int64_t overrun_cycle = -1;     ///< negative control: this cycle spends more than its budget; -1: none does
};

/// The loop proper: what happens between the newest state of the device and the command that answers it.
/// cycle() and answer() use no heap, lock, system call, exception or clock.
class ControlLoop {
 public:
  using State = DeviceState;
  using Command = LoopCommand;

  struct Wrench {
    Double3 force, torque;
  };

  /// `body` must outlive the loop.
  ControlLoop(ContactBody& body, const LoopSetup& setup) : body_(&body), setup_(setup) {}

  /// Touches the body with the tools where the device says they are. A state that is not finite is refused like a
  /// contact that is not: held_not_finite, and the last good force stays.
  void cycle(const DeviceState& state) noexcept;

  /// Writes the answer to the last cycle and adds its response to the digest.
  void answer(LoopCommand& command) noexcept;

  /// Steps the reference body, if there is one, with the tools of the last cycle: what stepping as fast would feel.
  void refer() noexcept;

  [[nodiscard]] Budget budget() const noexcept { return budget_; }  ///< of the last cycle
  /// What a tool feels as of the last cycle, N and N m: between steps by the local model, from whose sides no tool
  /// pulls.
  [[nodiscard]] const Wrench& felt(std::size_t tool) const noexcept { return felt_[tool]; }
  /// Whether the last cycle was one between steps, and the tools' motion within the local model's range.
  [[nodiscard]] bool between() const noexcept { return between_; }
  [[nodiscard]] bool in_range() const noexcept { return in_range_; }
  [[nodiscard]] std::uint64_t local_work() const noexcept { return local_work_; }  ///< units, of the last local model
  [[nodiscard]] const ContactBody::StepReport& report() const noexcept { return report_; }
  [[nodiscard]] std::span<const ContactBody::ToolInput> tools() const noexcept { return {tool_.data(), tool_count_}; }
  /// What the tools feel, as of the last cycle that was answered.
  [[nodiscard]] std::span<const ContactBody::ToolAnswer> answers() const noexcept { return body_->tools(); }
  [[nodiscard]] std::span<const ContactBody::Contact> contacts() const noexcept { return body_->contacts(); }
  /// Units that finding what touches the last cycle's tools takes at most.
  [[nodiscard]] std::uint64_t touching_bound() const noexcept { return body_->touching_work(tools()); }
  [[nodiscard]] const ContactBody::Energy& energy() const noexcept { return body_->energy(); }
  /// [nodes] m, as of the last cycle that was answered, motions and all.
  [[nodiscard]] std::span<const Vec4> field() const noexcept {
    return setup_.vibrating != nullptr ? setup_.vibrating->displacement() : body_->displacement();
  }
  /// Of a vibrating body, else as nothing moves.
  [[nodiscard]] const ImpulseResponse::StepReport& motion() const noexcept { return motion_; }
  [[nodiscard]] std::uint32_t impulse() const noexcept { return impulse_; }  ///< of the last cycle, or no_impulse
  [[nodiscard]] bool field_is_new() const noexcept { return field_is_new_; }
  [[nodiscard]] const LoopSetup& setup() const noexcept { return setup_; }

 private:
  [[nodiscard]] bool read(const DeviceState& state) noexcept;
  [[nodiscard]] ContactBody::StepReport step(Budget budget) noexcept;
  void keep() noexcept;
  void follow() noexcept;
  void overrun() noexcept;

  ContactBody* body_;
  LoopSetup setup_;
  std::array<ContactBody::ToolInput, max_tools> tool_{};
  std::size_t tool_count_ = 0;
  Elastostatic::Loads loads_;
  Budget budget_;
  std::array<Wrench, max_tools> felt_{};
  LocalModel local_;                             ///< of the last step; of no tools: there is none
  std::array<Double3, max_tools> stepped_at_{};  ///< m, where the tools were
  std::uint64_t local_work_ = 0;
  bool between_ = false, in_range_ = false;
  std::int64_t cycle_ = 0;
  bool field_is_new_ = false;
  ContactBody::StepReport report_;
  ImpulseResponse::StepReport motion_;
  std::uint32_t impulse_ = ImpulseResponse::no_impulse;
  Fnv1a digest_;
};

}  // namespace greenloop
