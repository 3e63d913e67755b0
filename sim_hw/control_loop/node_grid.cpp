#include "sim_hw/control_loop/node_grid.hpp"

#include <cmath>

namespace greenloop {
namespace {

struct Box {
  Double3 low, high;
};

Box bounding_box(const std::vector<Double3>& position, const std::vector<std::uint32_t>& nodes) {
  Box box{position[nodes.front()], position[nodes.front()]};
  for (const std::uint32_t node : nodes) {
    const Double3& p = position[node];
    box.low = {std::min(box.low.x, p.x), std::min(box.low.y, p.y), std::min(box.low.z, p.z)};
    box.high = {std::max(box.high.x, p.x), std::max(box.high.y, p.y), std::max(box.high.z, p.z)};
  }
  return box;
}

}  // namespace

NodeGrid::NodeGrid(const std::vector<Double3>& position, const std::vector<std::uint32_t>& nodes, double cell) {
  const Box box = bounding_box(position, nodes);
  const Double3 size = box.high - box.low;
  const double width = std::max(cell, std::max({size.x, size.y, size.z}) / most_in_a_row);
  low_ = box.low;
  inverse_cell_ = 1 / width;
  const double extent[3] = {size.x, size.y, size.z};
  for (std::size_t i = 0; i < 3; ++i) {
    count_[i] = std::clamp(static_cast<int>(std::ceil(extent[i] * inverse_cell_)), 1, most_in_a_row);
  }
  // counting sort by cell
  begin_.assign(static_cast<std::size_t>(count_[0] * count_[1] * count_[2]) + 1, 0);
  for (const std::uint32_t node : nodes) ++begin_[number_of(cell_of(position[node])) + 1];
  for (std::size_t i = 1; i < begin_.size(); ++i) begin_[i] += begin_[i - 1];
  node_.resize(nodes.size());
  std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
  for (const std::uint32_t node : nodes) node_[next[number_of(cell_of(position[node]))]++] = node;
}

}  // namespace greenloop
