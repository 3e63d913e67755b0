#include "runtime/contact/node_grid.hpp"

#include <algorithm>

namespace greenloop {
namespace {

std::int32_t cells_along(double extent) {
  const auto whole = static_cast<std::int32_t>(extent);
  return std::clamp<std::int32_t>(whole + (extent > whole ? 1 : 0), 1, GridShape::most_in_a_row);
}

/// The last cell for what lies beyond, the first for what lies before or is no number.
std::int32_t clamped(double place, std::int32_t count) {
  if (!(place > 0)) return 0;
  return place < count - 1 ? static_cast<std::int32_t>(place) : count - 1;
}

}  // namespace

GridShape grid_shape(std::span<const Double3> position, std::span<const std::uint32_t> nodes, double cell) noexcept {
  GridShape shape;
  if (nodes.empty()) return shape;
  Double3 low = position[nodes.front()], high = low;
  for (const std::uint32_t node : nodes) {
    const Double3& p = position[node];
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const Double3 size = high - low;
  const double width = std::max(cell, std::max(std::max(size.x, size.y), size.z) / GridShape::most_in_a_row);
  shape.low = low;
  shape.inverse_cell = 1 / width;
  const double extent[3] = {size.x, size.y, size.z};
  for (int i = 0; i < 3; ++i) shape.count[i] = cells_along(extent[i] * shape.inverse_cell);
  return shape;
}

NodeGrid::Cell NodeGrid::cell_of(const Double3& point) const noexcept {
  const Double3 place = shape_.inverse_cell * (point - shape_.low);
  return {clamped(place.x, shape_.count[0]), clamped(place.y, shape_.count[1]), clamped(place.z, shape_.count[2])};
}

void NodeGrid::carve(Arena& arena, const GridShape& shape, std::size_t nodes) noexcept {
  shape_ = shape;
  begin_ = arena.take_zeroed<std::uint32_t>(std::uint64_t{shape.cells()} + 1);
  node_ = arena.take<std::uint32_t>(nodes);
}

// counting sort by cell
void NodeGrid::fill(std::span<const Double3> position, std::span<const std::uint32_t> nodes) noexcept {
  const std::uint32_t cells = shape_.cells();
  for (const std::uint32_t node : nodes) ++begin_[number_of(cell_of(position[node]))];
  std::uint32_t end = 0;
  for (std::uint32_t i = 0; i <= cells; ++i) begin_[i] = end += begin_[i];
  // from the back, so that each cell's end runs down to its beginning
  for (std::size_t i = nodes.size(); i-- > 0;) node_[--begin_[number_of(cell_of(position[nodes[i]]))]] = nodes[i];
}

}  // namespace greenloop
