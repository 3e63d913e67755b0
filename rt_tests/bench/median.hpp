#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace greenloop::bench {

/// The middle one of at least one value; of an even number the larger of the two. Work: linear on average.
[[nodiscard]] inline double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace greenloop::bench
