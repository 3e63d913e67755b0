#pragma once

#include <cstdint>

#include "sim_hw/device/command_arrival.hpp"
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

/// A person who pushes a scene of motions: an impulse every third of a second or so, now and then several in a row,
/// while the last still dies out; one in twenty is none of the palette, and whether one may follow is not asked. The
/// same in every run by its seed. It advances one cycle per command.
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
  [[nodiscard]] std::uint32_t below(std::uint32_t bound);
  void draw();

  ImpulseDeviceSetup setup_;
  CommandArrival arrival_;
  std::uint64_t random_;
  std::int64_t next_ = 0;    ///< cycle of the next impulse
  std::uint32_t burst_ = 0;  ///< impulses that follow it in a row
  ImpulseState state_;
  LinkSummary summary_;
};

}  // namespace greenloop
