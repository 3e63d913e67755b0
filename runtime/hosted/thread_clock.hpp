#pragma once

#include <cstdint>
#include <ctime>

namespace greenloop {

/// Processor time of the calling thread, ns. Calls the system.
[[nodiscard]] inline std::int64_t thread_nanoseconds() noexcept {
  timespec now{};
  (void)clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return std::int64_t{1000000000} * now.tv_sec + now.tv_nsec;
}

}  // namespace greenloop
