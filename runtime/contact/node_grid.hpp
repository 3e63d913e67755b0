#pragma once

#include <cstdint>
#include <span>

#include "runtime/algebra/double3.hpp"
#include "runtime/memory/arena.hpp"

namespace greenloop {

/// Where the cells of a grid lie: its lowest corner, the width of its cubes and how many there are along each axis.
struct GridShape {
  static constexpr std::int32_t most_in_a_row = 64;

  Double3 low;              ///< m
  double inverse_cell = 1;  ///< 1/m
  std::int32_t count[3] = {1, 1, 1};

  [[nodiscard]] std::uint32_t cells() const noexcept {
    return static_cast<std::uint32_t>(count[0] * count[1] * count[2]);
  }
};

/// Cells of `cell` m (> 0) around the positions that `nodes` name, wider if there would be more than 64 in a row.
/// Start-up; linear in the nodes.
[[nodiscard]] GridShape grid_shape(std::span<const Double3> position, std::span<const std::uint32_t> nodes,
                                   double cell) noexcept;

/// Nodes sorted into cubic cells, to find those near a place.
class NodeGrid {
 public:
  /// Room for so many nodes.
  void carve(Arena& arena, const GridShape& shape, std::size_t nodes) noexcept;

  /// Sorts `nodes` in, which name the positions that the shape was made of. Start-up; linear in nodes and cells.
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

 private:
  struct Cell {
    std::int32_t x, y, z;
  };

  [[nodiscard]] Cell cell_of(const Double3& point) const noexcept;
  [[nodiscard]] std::uint32_t number_of(const Cell& cell) const noexcept {
    return static_cast<std::uint32_t>((cell.z * shape_.count[1] + cell.y) * shape_.count[0] + cell.x);
  }

  GridShape shape_;
  std::uint32_t* begin_ = nullptr;  ///< [cells + 1]
  std::uint32_t* node_ = nullptr;   ///< in the order of `fill` within a cell
};

}  // namespace greenloop
