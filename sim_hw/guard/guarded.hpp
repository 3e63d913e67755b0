#pragma once

#include <cstdint>

#include "sim_hw/guard/allocation_guard.hpp"
#include "sim_hw/guard/mutex_guard.hpp"
#include "sim_hw/guard/system_call_guard.hpp"

namespace greenloop {

/// What the calling thread did that a loop must not: heap, locks, and armed sections with a system call.
struct GuardCounts {
  std::uint64_t allocations = 0, locks = 0, system_calls = 0;

  /// Of the thread so far.
  [[nodiscard]] static GuardCounts total() noexcept {
    return {allocation_guard::count(), mutex_guard::count(), system_call_guard::count()};
  }
  GuardCounts& operator+=(const GuardCounts& other) noexcept {
    allocations += other.allocations;
    locks += other.locks;
    system_calls += other.system_calls;
    return *this;
  }
};

/// Runs `section` with all guards armed. System calls are counted only once the guard against them is installed.
template <typename Section>
[[nodiscard]] GuardCounts guarded(Section section) {
  const GuardCounts before = GuardCounts::total();
  allocation_guard::arm();
  mutex_guard::arm();
  system_call_guard::arm();
  section();
  system_call_guard::disarm();
  mutex_guard::disarm();
  allocation_guard::disarm();
  const GuardCounts after = GuardCounts::total();
  return {after.allocations - before.allocations, after.locks - before.locks, after.system_calls - before.system_calls};
}

}  // namespace greenloop
