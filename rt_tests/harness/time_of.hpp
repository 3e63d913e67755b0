#pragma once

#include <cstddef>

#include "runtime/hosted/thread_clock.hpp"

namespace greenloop {

/// Processor time of this thread.
[[nodiscard]] inline double thread_microseconds() { return 1e-3 * static_cast<double>(thread_nanoseconds()); }

/// Microseconds of one of `calls` calls of `work`, by the processor time of this thread.
template <class Work>
double time_of(std::size_t calls, Work work) {
  const double begin = thread_microseconds();
  for (std::size_t i = 0; i < calls; ++i) {
    work();
  }
  return (thread_microseconds() - begin) / static_cast<double>(calls);
}

}  // namespace greenloop
