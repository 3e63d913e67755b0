#pragma once

#include <cmath>
#include <cstdint>

#include "runtime/algebra/double3.hpp"

namespace greenloop {

/// Nearest whole count of `value` at `resolution` (> 0, unit of `value`); halves go up. Beyond int32: its ends.
[[nodiscard]] inline std::int32_t encoder_counts(double value, double resolution) {
  const double counts = std::floor(value / resolution + 0.5);
  if (!(counts > -2147483648.0)) return INT32_MIN;
  return counts < 2147483647.0 ? static_cast<std::int32_t>(counts) : INT32_MAX;
}

/// The value that `counts` stand for: within half a resolution of what was measured.
[[nodiscard]] inline double encoder_value(std::int32_t counts, double resolution) { return counts * resolution; }

[[nodiscard]] inline Double3 encoder_value(const std::int32_t (&counts)[3], double resolution) {
  return {encoder_value(counts[0], resolution), encoder_value(counts[1], resolution),
          encoder_value(counts[2], resolution)};
}

}  // namespace greenloop
