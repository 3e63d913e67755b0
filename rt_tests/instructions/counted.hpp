#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "sim_hw/guard/instruction_counter.hpp"

namespace greenloop {

/// Instructions that `work` takes, by the counter, which must be installed.
template <class Work>
std::uint64_t count_instructions(Work work) {
  instruction_counter::start();
  work();
  return instruction_counter::stop();
}

inline bool all_equal(const std::vector<std::uint64_t>& counts) {
  return std::all_of(counts.begin(), counts.end(), [&](std::uint64_t c) { return c == counts[0]; });
}

}  // namespace greenloop
