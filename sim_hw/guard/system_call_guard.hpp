#pragma once

#include <cstdint>

/// Counts system calls of the calling thread, by Linux's Syscall User Dispatch (x86-64 and AArch64, Linux 5.11). After
/// the first one the guard is off until it is armed again, so that the count is of armed sections with a system call.
/// The call itself is carried out. Arm and disarm cost less than a nanosecond.
namespace greenloop::system_call_guard {

/// Prepares the calling thread, the only one to be watched; takes over SIGSYS. False if the kernel does not offer it.
[[nodiscard]] bool install() noexcept;

void arm() noexcept;
void disarm() noexcept;
[[nodiscard]] std::uint64_t count() noexcept;
/// Number of the last system call caught, -1 before the first.
[[nodiscard]] long last() noexcept;

}  // namespace greenloop::system_call_guard
