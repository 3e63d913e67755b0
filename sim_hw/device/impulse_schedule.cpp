#include "sim_hw/device/impulse_schedule.hpp"

#include <algorithm>

namespace greenloop {

std::uint32_t ImpulseSchedule::below(std::uint32_t bound) {
  random_ = random_ * 6364136223846793005U + 1442695040888963407U;
  return static_cast<std::uint32_t>((random_ >> 33U) * bound >> 31U);
}

std::int32_t ImpulseSchedule::next(std::int64_t cycle) {
  if (impulses_ == 0 || cycle < due_) return none;
  const auto impulse = static_cast<std::int32_t>(below(20) == 0 ? impulses_ : below(impulses_));
  if (burst_ > 0) {
    --burst_;
  } else if (below(6) == 0) {
    burst_ = 3 + below(5);
  }
  const double apart = (burst_ > 0 ? 0.002 : 0.1) + (burst_ > 0 ? 0.02 : 0.5) * below(1U << 16U) * 0x1p-16;
  due_ = cycle + std::max<std::int64_t>(1, static_cast<std::int64_t>(apart * rate_));
  return impulse;
}

}  // namespace greenloop
