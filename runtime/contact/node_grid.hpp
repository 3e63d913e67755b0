#pragma once

#include <cstdint>
#include <span>

#include "runtime/algebra/double3.hpp"
#include "runtime/memory/arena.hpp"

namespace greenloop {

/// Nodes sorted into cubic cells, to find those near a place.
class NodeGrid {
 public:
  static constexpr std::int32_t most_in_a_row = 64;

  /// Room for `nodes`, which name the positions (m) to sort in: cells of `cell` m (> 0) around them, wider if there
  /// would be more than 64 in a row. Start-up; linear in the nodes.
  void carve(Arena& arena, std::span<const Double3> position, std::span<const std::uint32_t> nodes,
             double cell) noexcept;

  /// Sorts in what there is room for. Start-up; linear in nodes and cells.
  void fill(std::span<const Double3> position, std::span<const std::uint32_t> nodes) noexcept;

  /// Calls visit(node) once for every node in the cells that the box `centre` +- `radius` meets, always in the same
  /// order. For the loop. Work: those cells, at most all of them, and their nodes.
  template <typename Visit>
  void near(const Double3& centre, double radius, Visit visit) const noexcept {
    const Cell low = cell_of(centre - Double3{radius, radius, radius});
    const Cell high = cell_of(centre + Double3{radius, radius, radius});
    for (std::int32_t z = low.z; z <= high.z; ++z) {
      for (std::int32_t y = low.y; y <= high.y; ++y) {
        // a row of cells is one run of nodes
        const std::uint32_t end = begin_[number_of({high.x, y, z}) + 1];
        for (std::uint32_t i = begin_[number_of({low.x, y, z})]; i < end; ++i) visit(node_[i]);
      }
    }
  }

  /// Along each axis.
  struct Cell {
    std::int32_t x, y, z;
  };
  [[nodiscard]] const Cell& cells() const noexcept { return count_; }

 private:
  [[nodiscard]] Cell cell_of(const Double3& point) const noexcept;
  [[nodiscard]] std::uint32_t number_of(const Cell& cell) const noexcept {
    return static_cast<std::uint32_t>((cell.z * count_.y + cell.y) * count_.x + cell.x);
  }
  [[nodiscard]] std::uint32_t cell_count() const noexcept {
    return static_cast<std::uint32_t>(count_.x * count_.y * count_.z);
  }

  Double3 low_;  ///< m, the lowest corner
  double inverse_cell_ = 1;
  Cell count_{1, 1, 1};
  std::uint32_t* begin_ = nullptr;  ///< [cells + 1]
  std::uint32_t* node_ = nullptr;   ///< in the order of `fill` within a cell
};

}  // namespace greenloop
