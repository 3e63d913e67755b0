#pragma once

#include <cstdint>

namespace greenloop::instruction_counter {

/// Counts the instructions of this thread between start and stop, exactly, on machines without a performance counter
/// too: the processor traps after every instruction (the trap flag), which takes some microseconds each. One thread at
/// a time. False where this cannot be done: processors other than x86-64.
[[nodiscard]] bool install() noexcept;

void start() noexcept;

/// Instructions since start, without those of start and stop themselves.
[[nodiscard]] std::uint64_t stop() noexcept;

}  // namespace greenloop::instruction_counter
