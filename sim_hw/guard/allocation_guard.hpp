#pragma once

#include <cstdint>

/// Counts what must not happen in the loop: allocations and frees, by malloc or new, of the calling thread between arm
/// and disarm. Interposes the C library's allocator (glibc); under AddressSanitizer it uses the sanitizer's hooks.
/// Callable in the loop; the count is the thread's total.
namespace greenloop::allocation_guard {

void arm() noexcept;
void disarm() noexcept;
[[nodiscard]] std::uint64_t count() noexcept;

}  // namespace greenloop::allocation_guard
