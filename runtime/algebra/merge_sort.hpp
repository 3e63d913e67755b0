#pragma once

#include <cstdint>

namespace greenloop {

/// Values times passes over them.
constexpr std::uint64_t merge_sort_steps(std::uint64_t count) {
  std::uint64_t passes = 0;
  while ((std::uint64_t{1} << passes) < count) {
    ++passes;
  }
  return passes * count;
}

/// Sorts values[count] stably by before(a, b); values and scratch[count] may change places. For the loop.
template <class Before>
void merge_sort(std::uint32_t count, std::uint32_t*& values, std::uint32_t*& scratch, Before before) {
  for (std::uint32_t width = 1; width < count; width *= 2) {
    for (std::uint32_t begin = 0; begin < count; begin += 2 * width) {
      const std::uint32_t middle = begin + width < count ? begin + width : count;
      const std::uint32_t end = begin + 2 * width < count ? begin + 2 * width : count;
      std::uint32_t left = begin;
      std::uint32_t right = middle;
      for (std::uint32_t k = begin; k < end; ++k) {
        const bool take_left = right == end || (left < middle && !before(values[right], values[left]));
        scratch[k] = take_left ? values[left++] : values[right++];
      }
    }
    std::uint32_t* const sorted = scratch;
    scratch = values;
    values = sorted;
  }
}

}  // namespace greenloop
