#pragma once

#include <cstddef>
#include <ctime>

namespace greenloop::bench {

/// Processor time of this thread.
inline double thread_microseconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e6 * static_cast<double>(now.tv_sec) + 1e-3 * static_cast<double>(now.tv_nsec);
}

/// Microseconds of one of `calls` calls of `work`.
template <class Work>
double time_of(std::size_t calls, Work work) {
  const double begin = thread_microseconds();
  for (std::size_t i = 0; i < calls; ++i) {
    work();
  }
  return (thread_microseconds() - begin) / static_cast<double>(calls);
}

}  // namespace greenloop::bench
