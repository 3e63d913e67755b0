#pragma once

#include <cstdint>
#include <vector>

#include "sim_hw/device/command_arrival.hpp"
#include "sim_hw/messages/drag_command.hpp"
#include "sim_hw/messages/drag_state.hpp"

namespace greenloop {

struct DragDeviceSetup {
  std::vector<std::uint32_t> vertices;  ///< of which the tool takes hold; none: of nothing
  double reach = 0.01;                  ///< m, how far it drags at most
  double rate = 1000;                   ///< Hz
  std::int64_t cycles = 0;              ///< how many the run has
  std::uint64_t seed = 1;
  InjectedFaults faults;
};

/// A tool that drags a soft body: it waits half a second, takes hold of a vertex, draws it out to a point within its
/// reach in half a second, along a curve to another in as much again, lets go, and so on. Virtual time, the same in
/// every run by its seed. It advances one cycle per command.
class DragDevice {
 public:
  using State = DragState;
  using Command = DragCommand;

  explicit DragDevice(DragDeviceSetup setup);

  /// What it does in the current cycle.
  [[nodiscard]] const DragState& state() const { return state_; }

  /// Takes the command of the current cycle, or drops it if it is late, and goes to the next cycle.
  void apply(const DragCommand& command);

  [[nodiscard]] bool finished() const { return summary_.stopped || summary_.cycles >= setup_.cycles; }
  [[nodiscard]] const LinkSummary& summary() const { return summary_; }
  [[nodiscard]] LinkSummary& summary() { return summary_; }

 private:
  [[nodiscard]] std::uint32_t below(std::uint32_t bound);
  void choose();
  void move();

  DragDeviceSetup setup_;
  CommandArrival arrival_;
  std::uint64_t random_;
  std::int64_t phase_ = 1;  ///< cycles of waiting, of drawing out, and of the curve
  std::uint32_t vertex_ = 0;
  double first_[3] = {}, second_[3] = {};  ///< m, ends of the two parts
  DragState state_;
  LinkSummary summary_;
};

}  // namespace greenloop
