#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include "runtime/passivity.hpp"
#include "sim_hw/body/body_surface.hpp"
#include "sim_hw/device/command_arrival.hpp"
#include "sim_hw/device/hand.hpp"
#include "sim_hw/device/impulse_schedule.hpp"
#include "sim_hw/device/motion_script.hpp"
#include "sim_hw/device/script.hpp"
#include "sim_hw/messages/device_state.hpp"
#include "sim_hw/messages/loop_command.hpp"

namespace greenloop {

/// How a device the size of a desk is coupled to a body of any size and stiffness, as haptic programs do it.
struct Coupling {
  static constexpr double reach = 0.1;        ///< m, how far the handle moves to either side
  static constexpr double resolution = 1e-5;  ///< m of the handle per encoder count

  double motion_scale = 1;  ///< m of the body per m of the handle
  double force_scale = 1;   ///< N on the handle per N on the probe

  /// What a stiffness of the body is at the handle, and an energy.
  [[nodiscard]] double stiffness_scale() const { return force_scale * motion_scale; }
  [[nodiscard]] double energy_scale() const { return force_scale / motion_scale; }
};

/// The whole body within reach; the force scaled down until a rigid sphere pressed into a half-space of the model's
/// material (Hertz, F = 4/3 E* sqrt(R) d^1.5) at two thirds of the target's depth balances half of the hand's spring.
[[nodiscard]] Coupling coupling(const layout::Info& info, const BodySurface& surface, const ProbeSize& probe,
                                const HandParameters& hand);

/// What the device knows about its run, counted on its side.
struct DeviceSummary : LinkSummary {
  // J, of the handles
  double delivered = 0;       ///< by the motors to the hands, net
  double delivered_most = 0;  ///< the most of it at any time, from 0: what the loop has made of nothing
  double overdrawn = 0;       ///< the most that went out beyond what the contacts stored and a reserve
  double drained = 0;         ///< by the tank's braking
};

/// How the device, and with it the body's frame, is turned against gravity: upright, or to one side and back.
struct Tilt {
  Double3 down;         ///< m/s^2, upright
  Double3 to_the_side;  ///< m/s^2, where it points half way
  double seconds = 1;   ///< there and back

  [[nodiscard]] Double3 at(double time) const;
};

struct DeviceSetup {
  std::vector<MotionScript> motion;  ///< of each tool, at most max_tools
  Coupling coupling;
  HandParameters hand;
  Double3 origin;           ///< m, middle of the workspace in the frame of the body
  double period = 1e-3;     ///< s
  std::int64_t cycles = 0;  ///< how many the run has
  InjectedFaults faults;
  std::int64_t delay = 0;  ///< cycles that a command is rendered later than its own
  EnergyTank::Settings tank{.enabled = false};
  Tilt gravity;
  ImpulseSchedule impulses;  ///< that the body's motions are given
};

/// A simulated haptic device: hands that pull its handles along a script, encoders, and motors that render the
/// loop's force. It advances one cycle per command, so its time is virtual and every run has the same bits.
class HapticDevice {
 public:
  using State = DeviceState;
  using Command = LoopCommand;

  explicit HapticDevice(DeviceSetup setup);

  /// What the encoders say at the start of the current cycle.
  [[nodiscard]] const DeviceState& state() const { return state_; }

  /// Renders the command of the current cycle, or holds the last one if it is late, and goes to the next cycle.
  void apply(const LoopCommand& command);

  [[nodiscard]] bool finished() const { return summary_.stopped || summary_.cycles >= setup_.cycles; }
  [[nodiscard]] const DeviceSummary& summary() const { return summary_; }
  [[nodiscard]] DeviceSummary& summary() { return summary_; }

 private:
  /// What a command says, at the handles.
  struct Rendering {
    std::vector<Double3> force;  ///< N
    double stored = 0;           ///< J
  };

  void receive(const LoopCommand& command);
  void render();
  void move();
  void measure();
  [[nodiscard]] Double3 handle_target(std::size_t probe, double time) const;

  DeviceSetup setup_;
  CommandArrival arrival_;
  std::vector<Hand> hands_;
  std::deque<Rendering> rendering_;   ///< held from one cycle to the next, then those that are under way
  std::vector<Double3> motor_force_;  ///< N on the handle
  EnergyTank tank_;
  DeviceState state_{};
  DeviceSummary summary_;
};

}  // namespace greenloop
