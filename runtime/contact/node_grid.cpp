#include "runtime/contact/node_grid.hpp"

#include <algorithm>

namespace greenloop {
namespace {

std::int32_t cells_along(double extent) {
  if (!(extent > 0)) return 1;
  const auto whole = static_cast<std::int32_t>(extent);
  return std::clamp<std::int32_t>(whole + (extent > whole ? 1 : 0), 1, NodeGrid::most_in_a_row);
}

/// The last cell for what lies beyond, the first for what lies before or is no number.
std::int32_t clamped(double place, std::int32_t count) {
  if (!(place > 0)) return 0;
  return place < count - 1 ? static_cast<std::int32_t>(place) : count - 1;
}

}  // namespace

NodeGrid::Cell NodeGrid::cell_of(const Double3& point) const noexcept {
  const Double3 place = inverse_cell_ * (point - low_);
  return {clamped(place.x, count_.x), clamped(place.y, count_.y), clamped(place.z, count_.z)};
}

void NodeGrid::carve(Arena& arena, std::span<const Double3> position, std::span<const std::uint32_t> nodes,
                     double cell) noexcept {
  low_ = position[nodes.front()];
  Double3 high = low_;
  for (const std::uint32_t node : nodes) {
    const Double3& p = position[node];
    low_ = {std::min(low_.x, p.x), std::min(low_.y, p.y), std::min(low_.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const Double3 size = high - low_;
  inverse_cell_ = 1 / std::max(cell, std::max(std::max(size.x, size.y), size.z) / most_in_a_row);
  const Double3 extent = inverse_cell_ * size;
  count_ = {cells_along(extent.x), cells_along(extent.y), cells_along(extent.z)};
  begin_ = arena.take_zeroed<std::uint32_t>(std::uint64_t{cell_count()} + 1);
  node_ = arena.take<std::uint32_t>(nodes.size());
}

// counting sort by cell
void NodeGrid::fill(std::span<const Double3> position, std::span<const std::uint32_t> nodes) noexcept {
  for (const std::uint32_t node : nodes) ++begin_[number_of(cell_of(position[node]))];
  std::uint32_t end = 0;
  for (std::uint32_t i = 0; i <= cell_count(); ++i) begin_[i] = end += begin_[i];
  // from the back, so that each cell's end runs down to its beginning
  for (std::size_t i = nodes.size(); i-- > 0;) node_[--begin_[number_of(cell_of(position[nodes[i]]))]] = nodes[i];
}

}  // namespace greenloop
