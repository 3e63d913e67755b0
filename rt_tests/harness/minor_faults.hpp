#pragma once

#include <sys/resource.h>

#include <cstdint>

namespace greenloop {

/// Page faults of the calling thread so far that took no reading from a disk.
[[nodiscard]] inline std::uint64_t minor_faults() {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return static_cast<std::uint64_t>(usage.ru_minflt);
}

}  // namespace greenloop
