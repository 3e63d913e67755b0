#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "runtime/algebra/fnv1a.hpp"
#include "runtime/impulse_response.hpp"
#include "sim_hw/messages/impulse_state.hpp"
#include "sim_hw/messages/motion_command.hpp"

namespace greenloop {

struct MotionSetup {
  Budget budget;                    ///< of every cycle, as ImpulseResponse::step has it
  std::int64_t field_every = 1;     ///< all vertices are displaced in every so-manieth cycle
  std::int64_t overrun_cycle = -1;  ///< negative control: this cycle spends more than its budget; -1: none does
};

/// The loop proper of a scene of motions: one step between the device's newest impulse and the command that answers it.
/// cycle() and answer() use no heap, lock, system call, exception or clock.
class MotionLoop {
 public:
  using State = ImpulseState;
  using Command = MotionCommand;

  /// `model` must outlive the loop. Takes the memory of its answers.
  MotionLoop(const Model& model, const ImpulseResponse& body, const MotionSetup& setup);

  /// Gives the scene the impulse, if it may follow, and lets a period pass; a refused one leaves everything as it was.
  void cycle(const ImpulseState& state) noexcept;

  /// Writes the answer to the last cycle and adds its response to the digest.
  void answer(MotionCommand& command) noexcept;

  [[nodiscard]] const ImpulseState& state() const noexcept { return state_; }
  [[nodiscard]] Budget budget() const noexcept { return setup_.budget; }
  [[nodiscard]] const ImpulseResponse::StepReport& report() const noexcept { return report_; }
  /// Whether the last cycle was to displace all vertices.
  [[nodiscard]] bool displays() const noexcept { return displays_; }
  [[nodiscard]] std::span<const float> coordinate() const noexcept { return coordinate_; }     ///< [modes] m
  [[nodiscard]] std::span<const float> velocity() const noexcept { return velocity_; }         ///< [modes] m/s
  [[nodiscard]] std::span<const Vec3> displacement() const noexcept { return displacement_; }  ///< m, of the last frame

 private:
  ImpulseResponse body_;
  MotionSetup setup_;
  ImpulseState state_;
  ImpulseResponse::StepReport report_;
  bool displays_ = false;
  std::vector<float> coordinate_, velocity_;
  std::vector<Vec3> displacement_;
  Fnv1a digest_;
};

}  // namespace greenloop
