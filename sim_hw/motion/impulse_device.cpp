#include "sim_hw/motion/impulse_device.hpp"

#include <algorithm>

namespace greenloop {

ImpulseDevice::ImpulseDevice(const ImpulseDeviceSetup& setup)
    : setup_(setup), arrival_(setup.faults), random_(2 * setup.seed + 1) {
  draw();
}

std::uint32_t ImpulseDevice::below(std::uint32_t bound) {
  random_ = random_ * 6364136223846793005U + 1442695040888963407U;
  return static_cast<std::uint32_t>((random_ >> 33U) * bound >> 31U);
}

void ImpulseDevice::draw() {
  state_.impulse = -1;
  if (state_.cycle < next_) return;
  state_.impulse = static_cast<std::int32_t>(below(20) == 0 ? setup_.impulses : below(setup_.impulses));
  if (burst_ > 0) {
    --burst_;
  } else if (below(6) == 0) {
    burst_ = 3 + below(5);
  }
  const double apart = (burst_ > 0 ? 0.002 : 0.1) + (burst_ > 0 ? 0.02 : 0.5) * below(1U << 16U) * 0x1p-16;
  next_ = state_.cycle + std::max<std::int64_t>(1, static_cast<std::int64_t>(apart * setup_.rate));
}

void ImpulseDevice::apply(const MotionCommand& command) {
  if (arrival_.late(command.cycle, command.work, command.budget)) {
    summary_.late_injected += arrival_.injected(command.cycle) ? 1 : 0;
  }
  summary_.late = arrival_.late_count();
  summary_.stopped = arrival_.must_stop();
  summary_.digest = command.digest;
  ++summary_.cycles;
  ++state_.cycle;
  draw();
}

}  // namespace greenloop
