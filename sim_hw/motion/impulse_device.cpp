#include "sim_hw/motion/impulse_device.hpp"

namespace greenloop {

ImpulseDevice::ImpulseDevice(const ImpulseDeviceSetup& setup)
    : setup_(setup), arrival_(setup.faults), schedule_(setup.impulses, setup.rate, setup.seed) {
  state_.impulse = schedule_.next(state_.cycle);
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
  state_.impulse = schedule_.next(state_.cycle);
}

}  // namespace greenloop
