#pragma once

#include <cstdint>

namespace greenloop {

/// What the cycles of any loop come to.
struct CycleTally {
  std::int64_t cycles = 0;
  std::int64_t misses = 0;       ///< cycles that broke their budget, or could not be answered within it
  std::int64_t first_miss = -1;  ///< its cycle, -1: none
  std::uint64_t worst_work = 0;  ///< units
};

}  // namespace greenloop
