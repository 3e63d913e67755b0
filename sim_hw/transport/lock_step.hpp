#pragma once

#include <cstdint>
#include <functional>

#include "sim_hw/device/haptic_device.hpp"
#include "sim_hw/messages/device_state.hpp"
#include "sim_hw/messages/loop_command.hpp"

namespace greenloop {

/// The device's half of the lock step: state k goes out, nothing happens until command k is there. A lost packet
/// costs wall time and a retransmission, but changes nothing in virtual time.
class DeviceEnd {
 public:
  static constexpr int patience_ms = 50;     ///< silence after which a state is sent again
  static constexpr int most_silences = 200;  ///< 10 s without the answer: the loop is gone

  DeviceEnd(HapticDevice& device, std::function<void(const DeviceState&)> send);

  void start();

  /// Commands of other cycles, answers to retransmissions, are ignored.
  void receive(const LoopCommand& command);

  /// To be called after `patience_ms` without a message. Throws std::runtime_error after `most_silences` in a row.
  void silence();

 private:
  HapticDevice* device_;
  std::function<void(const DeviceState&)> send_;
  int silences_ = 0;
};

/// The loop's half: every state is computed once, in order; one that comes again gets the same answer again.
class LoopEnd {
 public:
  LoopEnd(std::function<const LoopCommand&(const DeviceState&)> answer, std::function<void(const LoopCommand&)> send);

  void receive(const DeviceState& state);

 private:
  std::function<const LoopCommand&(const DeviceState&)> answer_;
  std::function<void(const LoopCommand&)> send_;
  std::int64_t next_ = 0;
  LoopCommand last_{};
};

}  // namespace greenloop
