#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

namespace greenloop::offline {

/// The points with whole coordinates from 0 to size - 1, x fastest. Everything in this room is measured in its spacing.
struct Lattice {
  std::array<int, 3> size;

  [[nodiscard]] std::size_t count() const {
    return static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) * static_cast<std::size_t>(size[2]);
  }
  [[nodiscard]] std::size_t stride(int axis) const {
    std::size_t result = 1;
    for (int a = 0; a < axis; ++a) result *= static_cast<std::size_t>(size[a]);
    return result;
  }
  [[nodiscard]] std::size_t index(const std::array<int, 3>& point) const {
    return static_cast<std::size_t>(point[0]) + stride(1) * static_cast<std::size_t>(point[1]) +
           stride(2) * static_cast<std::size_t>(point[2]);
  }
  [[nodiscard]] std::array<int, 3> point(std::size_t index) const {
    return {static_cast<int>(index % stride(1)), static_cast<int>(index / stride(1)) % size[1],
            static_cast<int>(index / stride(2))};
  }
  /// Whether the point has a neighbour on all sides.
  [[nodiscard]] bool inner(const std::array<int, 3>& point) const {
    for (int a = 0; a < 3; ++a) {
      if (point[a] < 1 || point[a] + 1 >= size[a]) return false;
    }
    return true;
  }
};

}  // namespace greenloop::offline
