#pragma once

#include <cstdint>

#include "sim_hw/device/command_arrival.hpp"
#include "sim_hw/device/impulse_schedule.hpp"
#include "sim_hw/messages/impulse_state.hpp"
#include "sim_hw/messages/motion_command.hpp"

namespace greenloop {

struct ImpulseDeviceSetup {
  std::uint32_t impulses = 1;  ///< of the palette
  double rate = 1000;          ///< Hz
  std::int64_t cycles = 0;     ///< how many the run has
  std::uint64_t seed = 1;
  InjectedFaults faults;
};

/// Gives a scene of motions the impulses of a schedule. It advances one cycle per command.
class ImpulseDevice {
 public:
  using State = ImpulseState;
  using Command = MotionCommand;

  explicit ImpulseDevice(const ImpulseDeviceSetup& setup);

  /// What it gives in the current cycle.
  [[nodiscard]] const ImpulseState& state() const { return state_; }

  /// Takes the command of the current cycle, or drops it if it is late, and goes to the next cycle.
  void apply(const MotionCommand& command);

  [[nodiscard]] bool finished() const { return summary_.stopped || summary_.cycles >= setup_.cycles; }
  [[nodiscard]] const LinkSummary& summary() const { return summary_; }
  [[nodiscard]] LinkSummary& summary() { return summary_; }

 private:
  ImpulseDeviceSetup setup_;
  CommandArrival arrival_;
  ImpulseSchedule schedule_;
  ImpulseState state_;
  LinkSummary summary_;
};

}  // namespace greenloop
