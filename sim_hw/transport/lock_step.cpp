#include "sim_hw/transport/lock_step.hpp"

#include <stdexcept>
#include <string>
#include <utility>

namespace greenloop {

DeviceEnd::DeviceEnd(HapticDevice& device, std::function<void(const DeviceState&)> send)
    : device_(&device), send_(std::move(send)) {}

void DeviceEnd::start() { send_(device_->state()); }

void DeviceEnd::receive(const LoopCommand& command) {
  if (device_->finished() || command.cycle != device_->state().cycle) return;
  silences_ = 0;
  device_->apply(command);
  if (!device_->finished()) send_(device_->state());
}

void DeviceEnd::silence() {
  if (++silences_ > most_silences) {
    throw std::runtime_error("device: no command for cycle " + std::to_string(device_->state().cycle) + " after " +
                             std::to_string(most_silences) + " retransmissions; the control loop is gone");
  }
  ++device_->summary().retransmits;
  send_(device_->state());
}

LoopEnd::LoopEnd(std::function<const LoopCommand&(const DeviceState&)> answer,
                 std::function<void(const LoopCommand&)> send)
    : answer_(std::move(answer)), send_(std::move(send)) {}

void LoopEnd::receive(const DeviceState& state) {
  if (state.cycle == next_) {
    last_ = answer_(state);
    ++next_;
  } else if (state.cycle != next_ - 1) {
    return;
  }
  send_(last_);
}

}  // namespace greenloop
