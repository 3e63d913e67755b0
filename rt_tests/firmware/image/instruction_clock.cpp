#include "rt_tests/firmware/image/instruction_clock.hpp"

namespace greenloop::firmware {
namespace {

// CMSDK APB timer 0: control, value, reload; counts down
struct Timer {
  volatile std::uint32_t control, value, reload, interrupt;
};

struct SystemTimer {
  volatile std::uint32_t control, reload, value;
};

Timer& timer() { return *reinterpret_cast<Timer*>(0x40000000); }
SystemTimer& system_timer() { return *reinterpret_cast<SystemTimer*>(0xe000e010); }

constexpr std::uint32_t largest = 0xffffffff;

}  // namespace

void start_instruction_clock() {
  timer().reload = largest;
  timer().value = largest;
  timer().control = 1;
}

std::uint64_t instructions() { return std::uint64_t{largest - timer().value} * instructions_per_tick; }

void start_periodic_interrupt(std::uint32_t instructions) {
  constexpr std::uint32_t processor_clock_interrupt_enable = 7;
  system_timer().reload = instructions / instructions_per_tick - 1;
  system_timer().value = 0;
  system_timer().control = processor_clock_interrupt_enable;
}

void stop_periodic_interrupt() { system_timer().control = 0; }

bool periodic_interrupt_waits() {
  constexpr std::uint32_t system_timer_waits = 1U << 26;
  return (*reinterpret_cast<volatile std::uint32_t*>(0xe000ed04) & system_timer_waits) != 0;
}

}  // namespace greenloop::firmware
