#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "formats/write/aligned_bytes.hpp"
#include "runtime/algebra/fnv1a.hpp"
#include "runtime/contact/sphere_contacts.hpp"
#include "sim_hw/body/body_surface.hpp"
#include "sim_hw/control_loop/loop_body.hpp"
#include "sim_hw/messages/device_state.hpp"
#include "sim_hw/messages/loop_command.hpp"

namespace greenloop {

struct LoopSetup {
  double probe_radius = 0;          ///< m, > 0
  std::uint32_t max_contacts = 64;  ///< as in the body's Limits, at most LoopCommand::max_contacts
  Budget budget;                    ///< of every cycle
  std::int64_t field_every = 1;     ///< the displacement of the whole body in every so-manieth cycle
  std::int64_t overrun_cycle = -1;  ///< negative control: this cycle spends more than its budget; -1: none does
};

/// The loop proper: what happens between the newest state of the device and the command that answers it.
/// The constructor allocates everything; cycle() and answer() use no heap, lock, system call, exception or clock.
class ControlLoop {
 public:
  /// `body` and `surface` must outlive the loop. `body` was created for LoopSetup::max_contacts.
  ControlLoop(LoopBody& body, const BodySurface& surface, const LoopSetup& setup);

  /// Finds the contacts, steps the body, sums the force on every probe. A state that is not finite is refused like a
  /// contact that is not: held_not_finite, and the last good force stays.
  void cycle(const DeviceState& state) noexcept;

  /// Writes the answer to the last cycle and adds its response to the digest.
  void answer(LoopCommand& command) noexcept;

  [[nodiscard]] const LoopReport& report() const noexcept { return report_; }
  [[nodiscard]] std::span<const SphereTool> probes() const noexcept { return {probe_.data(), probe_count_}; }
  [[nodiscard]] std::span<const Double3> hand_force() const noexcept { return {hand_force_.data(), probe_count_}; }
  [[nodiscard]] std::span<const Constraint> contacts() const noexcept { return contacts_; }
  /// [4 * node_count] m, as of the last cycle that asked for it.
  [[nodiscard]] std::span<const float> field() const noexcept { return body_->field(); }
  [[nodiscard]] bool field_is_new() const noexcept { return field_is_new_; }
  [[nodiscard]] const LoopSetup& setup() const noexcept { return setup_; }

 private:
  [[nodiscard]] bool read(const DeviceState& state) noexcept;
  void step(std::int64_t cycle) noexcept;
  void overrun() noexcept;
  void sum_hand_force() noexcept;

  LoopBody* body_;
  LoopSetup setup_;
  std::vector<std::uint32_t> touchable_;
  AlignedBytes contact_memory_;
  SphereContacts sphere_contacts_;
  std::array<SphereTool, max_tools> probe_{};
  std::array<Double3, max_tools> hand_force_{};
  std::size_t probe_count_ = 0;
  std::int64_t cycle_ = 0;
  std::span<const Constraint> contacts_;
  bool field_is_new_ = false;
  LoopReport report_;
  Fnv1a digest_;
};

}  // namespace greenloop
