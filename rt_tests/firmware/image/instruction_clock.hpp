#pragma once

#include <cstdint>

namespace greenloop::firmware {

// QEMU with -icount shift=0 lets one nanosecond pass for every instruction, and the timers of the mps2 boards count at
// 25 MHz: a timer tick is 40 instructions. QEMU's Cortex-M7 has no cycle counter (DWT) to read.
inline constexpr std::uint32_t instructions_per_tick = 40;

/// Starts the free-running timer behind `instructions`.
void start_instruction_clock();

/// Instructions executed so far, to within one tick; wraps after 1.7e11.
[[nodiscard]] std::uint64_t instructions();

/// Calls timer_interrupt every `instructions`, at most 2^24 ticks, by SysTick.
void start_periodic_interrupt(std::uint32_t instructions);
void stop_periodic_interrupt();

/// Whether the next interrupt already waits: the current one took longer than the period.
[[nodiscard]] bool periodic_interrupt_waits();

}  // namespace greenloop::firmware
