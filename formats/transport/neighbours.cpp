#include "formats/transport/neighbours.hpp"

#include <algorithm>
#include <utility>

namespace greenloop::transport {
namespace {

constexpr std::size_t window = 128;

// the binary digits of the three coordinates in turn (Morton)
std::uint64_t place_on_curve(const GridPoint& point) {
  std::uint64_t place = 0;
  for (int bit = 16; bit >= 0; --bit) {
    for (const std::int32_t coordinate : point) {
      place = place << 1 | (static_cast<std::uint32_t>(coordinate + (1 << 16)) >> bit & 1);
    }
  }
  return place;
}

}  // namespace

std::uint64_t squared_distance(const GridPoint& a, const GridPoint& b) {
  std::uint64_t sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::int64_t difference = std::int64_t{a[k]} - b[k];
    sum += static_cast<std::uint64_t>(difference * difference);
  }
  return sum;
}

std::vector<Neighbours> neighbours_before(std::span<const GridPoint> points) {
  std::vector<std::pair<std::uint64_t, std::uint32_t>> curve(points.size());
  for (std::uint32_t i = 0; i < points.size(); ++i) curve[i] = {place_on_curve(points[i]), i};
  std::sort(curve.begin(), curve.end());

  std::vector<Neighbours> neighbours(points.size());
  std::vector<std::pair<std::uint64_t, std::uint32_t>> near;
  for (std::size_t at = 0; at < curve.size(); ++at) {
    const std::uint32_t i = curve[at].second;
    near.clear();
    for (std::size_t k = at - std::min(at, window); k < std::min(at + window + 1, curve.size()); ++k) {
      const std::uint32_t j = curve[k].second;
      if (j < i) near.emplace_back(squared_distance(points[i], points[j]), j);
    }
    const auto count = static_cast<std::ptrdiff_t>(std::min(near.size(), neighbour_count));
    std::partial_sort(near.begin(), near.begin() + count, near.end());
    neighbours[i].fill(no_neighbour);
    for (std::ptrdiff_t k = 0; k < count; ++k) neighbours[i][static_cast<std::size_t>(k)] = near[k].second;
  }
  return neighbours;
}

}  // namespace greenloop::transport
