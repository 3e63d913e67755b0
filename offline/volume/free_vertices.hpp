#pragma once

#include <cstdint>
#include <vector>

namespace greenloop::offline {

/// Degrees of freedom 3v + i of the vertices that are not fixed, numbered in vertex order.
struct FreeVertices {
  std::vector<int> number;  ///< per vertex: its number among the free ones, or -1 when fixed
  int count = 0;

  /// `fixed` holds one byte per vertex, nonzero = fixed.
  explicit FreeVertices(const std::vector<std::uint8_t>& fixed) : number(fixed.size(), -1) {
    for (std::size_t v = 0; v < fixed.size(); ++v) {
      if (fixed[v] == 0) number[v] = count++;
    }
  }
};

}  // namespace greenloop::offline
