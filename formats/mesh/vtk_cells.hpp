#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "formats/mesh/number_array.hpp"

namespace greenloop {

/// The cells of a VTK grid: the points of cell i are points[offsets[i]] to points[offsets[i + 1] - 1].
struct VtkCells {
  std::vector<std::size_t> offsets{0};
  std::vector<int> points;
  std::vector<std::size_t> lines;  ///< where each of `points` stands in its file; 0 in bytes

  [[nodiscard]] std::size_t size() const { return offsets.size() - 1; }
  [[nodiscard]] std::span<const int> operator[](std::size_t cell) const {
    return std::span(points).subspan(offsets[cell], offsets[cell + 1] - offsets[cell]);
  }

  void read_point(NumberArray& numbers, std::size_t point_count) {
    const auto last = static_cast<std::int64_t>(point_count) - 1;
    points.push_back(static_cast<int>(numbers.integer("a point index", 0, last)));
    lines.push_back(numbers.line());
  }

  /// The end of the next cell.
  void read_offset(NumberArray& numbers) {
    const auto low = static_cast<std::int64_t>(offsets.back());
    offsets.push_back(static_cast<std::size_t>(numbers.integer("the offset where a cell ends", low, largest_index)));
  }

  void require_last_offset(const NumberArray& numbers) const {
    if (offsets.back() != points.size()) {
      numbers.fail(std::to_string(points.size()) + " point indices of cells",
                   std::to_string(offsets.back()) + " as the last offset says");
    }
  }
};

}  // namespace greenloop
