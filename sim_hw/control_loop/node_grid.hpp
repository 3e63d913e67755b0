#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "runtime/algebra/double3.hpp"

namespace greenloop {

/// Points sorted into cubic cells, to find those near a place. Built at start-up; looking up is safe in the loop.
class NodeGrid {
 public:
  /// `nodes` name the `position`s to sort in; cells are `cell` m wide (> 0), wider if there would be more than 64 in a
  /// row.
  NodeGrid(const std::vector<Double3>& position, const std::vector<std::uint32_t>& nodes, double cell);

  /// Calls visit(node) once for every node in the cells that the box `centre` +- `radius` meets, always in the same
  /// order. No heap. Work: those cells, at most all of them, and their nodes.
  template <typename Visit>
  void near(const Double3& centre, double radius, Visit visit) const noexcept {
    const std::array<int, 3> low = cell_of(centre - Double3{radius, radius, radius});
    const std::array<int, 3> high = cell_of(centre + Double3{radius, radius, radius});
    for (int z = low[2]; z <= high[2]; ++z) {
      for (int y = low[1]; y <= high[1]; ++y) {
        for (int x = low[0]; x <= high[0]; ++x) {
          const std::size_t cell = number_of({x, y, z});
          for (std::uint32_t i = begin_[cell]; i < begin_[cell + 1]; ++i) visit(node_[i]);
        }
      }
    }
  }

 private:
  static constexpr int most_in_a_row = 64;

  [[nodiscard]] std::array<int, 3> cell_of(const Double3& point) const noexcept {
    const Double3 place = inverse_cell_ * (point - low_);
    return {clamped(place.x, 0), clamped(place.y, 1), clamped(place.z, 2)};
  }
  [[nodiscard]] int clamped(double place, int axis) const noexcept {
    return static_cast<int>(std::clamp(place, 0.0, static_cast<double>(count_[axis] - 1)));
  }
  [[nodiscard]] std::size_t number_of(const std::array<int, 3>& cell) const noexcept {
    const int number = (cell[2] * count_[1] + cell[1]) * count_[0] + cell[0];  // below most_in_a_row cubed
    return static_cast<std::size_t>(number);
  }

  Double3 low_;
  double inverse_cell_ = 1;
  std::array<int, 3> count_{1, 1, 1};
  std::vector<std::uint32_t> begin_;  ///< [cells + 1]
  std::vector<std::uint32_t> node_;   ///< increasing within a cell
};

}  // namespace greenloop
