#pragma once

#include <lcm/lcm.h>

#include <functional>
#include <memory>
#include <string>

#include "sim_hw/messages/device_state.hpp"
#include "sim_hw/messages/drag_command.hpp"
#include "sim_hw/messages/drag_state.hpp"
#include "sim_hw/messages/impulse_state.hpp"
#include "sim_hw/messages/loop_command.hpp"
#include "sim_hw/messages/motion_command.hpp"

namespace greenloop {

/// Sends and receives a device's states and a loop's commands through LCM. Never for the loop itself: it blocks,
/// allocates and calls the system. One thread uses a channel.
class Channel {
 public:
  /// Only these two places are ever sent to: multicast with a time to live of 0, which stays on this machine, and the
  /// memory of this process.
  static constexpr const char* multicast = "udpm://239.255.76.67:7667?ttl=0";
  static constexpr const char* memory = "memq://";

  /// Throws std::runtime_error if LCM refuses `url`.
  explicit Channel(const char* url);

  void on_state(std::function<void(const DeviceState&)> receive);
  void on_command(std::function<void(const LoopCommand&)> receive);
  void on_state(std::function<void(const ImpulseState&)> receive);
  void on_command(std::function<void(const MotionCommand&)> receive);
  void on_state(std::function<void(const DragState&)> receive);
  void on_command(std::function<void(const DragCommand&)> receive);
  void send(const DeviceState& state);
  void send(const LoopCommand& command);
  void send(const ImpulseState& state);
  void send(const MotionCommand& command);
  void send(const DragState& state);
  void send(const DragCommand& command);

  /// Waits for one message at most `milliseconds` and passes it on. False if none came.
  bool receive(int milliseconds);

 private:
  struct Destroy {
    void operator()(lcm_t* lcm) const { lcm_destroy(lcm); }
  };
  // filled before the subscription that uses them
  std::function<void(const DeviceState&)> receive_state_;
  std::function<void(const LoopCommand&)> receive_command_;
  std::function<void(const ImpulseState&)> receive_impulse_;
  std::function<void(const MotionCommand&)> receive_motion_;
  std::function<void(const DragState&)> receive_drag_;
  std::function<void(const DragCommand&)> receive_dragged_;
  std::unique_ptr<lcm_t, Destroy> lcm_;
};

}  // namespace greenloop
