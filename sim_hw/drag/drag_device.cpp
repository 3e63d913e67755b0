#include "sim_hw/drag/drag_device.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace greenloop {
namespace {

constexpr double phase_seconds = 0.5;

// from 0 to 1 with no velocity at the ends
double eased(double t) { return t * t * (3 - 2 * t); }

}  // namespace

DragDevice::DragDevice(DragDeviceSetup setup)
    : setup_(std::move(setup)),
      arrival_(setup_.faults),
      random_(2 * setup_.seed + 1),
      phase_(std::max<std::int64_t>(1, std::llround(phase_seconds * setup_.rate))) {
  move();
}

std::uint32_t DragDevice::below(std::uint32_t bound) {
  random_ = random_ * 6364136223846793005U + 1442695040888963407U;
  return static_cast<std::uint32_t>((random_ >> 33U) * bound >> 31U);
}

void DragDevice::choose() {
  vertex_ = setup_.vertices[below(static_cast<std::uint32_t>(setup_.vertices.size()))];
  // in a cube whose corners are within reach
  const double side = 2 * setup_.reach / std::sqrt(3.0);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    first_[axis] = side * (below(1U << 16U) * 0x1p-16 - 0.5);
    second_[axis] = side * (below(1U << 16U) * 0x1p-16 - 0.5);
  }
}

void DragDevice::move() {
  const std::int64_t place = state_.cycle % (3 * phase_), part = place / phase_;
  state_.vertex = -1;
  if (part == 0 || setup_.vertices.empty()) return;
  if (place == phase_) choose();
  state_.vertex = static_cast<std::int32_t>(vertex_);
  const double t = eased(static_cast<double>(place % phase_) / static_cast<double>(phase_));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double from = part == 1 ? 0 : first_[axis], to = part == 1 ? first_[axis] : second_[axis];
    state_.travel[axis] = from + t * (to - from);
  }
}

void DragDevice::apply(const DragCommand& command) {
  if (arrival_.late(command.cycle, command.work, command.budget)) {
    summary_.late_injected += arrival_.injected(command.cycle) ? 1 : 0;
  }
  summary_.late = arrival_.late_count();
  summary_.stopped = arrival_.must_stop();
  summary_.digest = command.digest;
  ++summary_.cycles;
  ++state_.cycle;
  move();
}

}  // namespace greenloop
