#pragma once

#include <cstdint>

/// Counts locks taken or waited for by the calling thread between arm and disarm: pthread mutexes, read-write locks,
/// spin locks, condition variables and semaphores. Interposes the C library. The count is the thread's total.
namespace greenloop::mutex_guard {

void arm() noexcept;
void disarm() noexcept;
[[nodiscard]] std::uint64_t count() noexcept;

}  // namespace greenloop::mutex_guard
