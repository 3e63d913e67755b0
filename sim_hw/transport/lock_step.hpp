#pragma once

#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>
#include <utility>

namespace greenloop {

inline constexpr int patience_ms = 50;     ///< silence after which a state is sent again
inline constexpr int most_silences = 200;  ///< 10 s without the answer: the loop is gone

/// The device's half of the lock step: state k goes out, nothing happens until command k is there. A lost packet
/// costs wall time and a retransmission, but changes nothing in virtual time.
template <class Device>
class DeviceEnd {
 public:
  using State = typename Device::State;
  using Command = typename Device::Command;

  DeviceEnd(Device& device, std::function<void(const State&)> send) : device_(&device), send_(std::move(send)) {}

  void start() { send_(device_->state()); }

  /// Commands of other cycles, answers to retransmissions, are ignored.
  void receive(const Command& command) {
    if (device_->finished() || command.cycle != device_->state().cycle) return;
    silences_ = 0;
    device_->apply(command);
    if (!device_->finished()) send_(device_->state());
  }

  /// To be called after `patience_ms` without a message. Throws std::runtime_error after `most_silences` in a row.
  void silence() {
    if (++silences_ > most_silences) {
      throw std::runtime_error("device: no command for cycle " + std::to_string(device_->state().cycle) + " after " +
                               std::to_string(most_silences) + " retransmissions; the control loop is gone");
    }
    ++device_->summary().retransmits;
    send_(device_->state());
  }

 private:
  Device* device_;
  std::function<void(const State&)> send_;
  int silences_ = 0;
};

/// The loop's half: every state is computed once, in order; one that comes again gets the same answer again.
template <class State, class Command>
class LoopEnd {
 public:
  LoopEnd(std::function<const Command&(const State&)> answer, std::function<void(const Command&)> send)
      : answer_(std::move(answer)), send_(std::move(send)) {}

  void receive(const State& state) {
    if (state.cycle == next_) {
      last_ = answer_(state);
      ++next_;
    } else if (state.cycle != next_ - 1) {
      return;
    }
    send_(last_);
  }

 private:
  std::function<const Command&(const State&)> answer_;
  std::function<void(const Command&)> send_;
  std::int64_t next_ = 0;
  Command last_{};
};

}  // namespace greenloop
