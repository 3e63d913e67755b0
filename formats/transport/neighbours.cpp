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

using Nearby = std::vector<std::pair<std::uint64_t, std::uint32_t>>;  // squared distance, point

void take_nearest(Nearby& near, std::span<std::uint32_t> found) {
  const std::size_t count = std::min(near.size(), found.size());
  std::partial_sort(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(count), near.end());
  std::fill(found.begin(), found.end(), no_neighbour);
  for (std::size_t k = 0; k < count; ++k) found[k] = near[k].second;
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

std::vector<Neighbours> neighbours_before(std::span<const GridPoint> points, std::size_t first) {
  std::vector<std::pair<std::uint64_t, std::uint32_t>> curve(points.size());
  for (std::uint32_t i = 0; i < points.size(); ++i) curve[i] = {place_on_curve(points[i]), i};
  std::sort(curve.begin(), curve.end());

  std::vector<Neighbours> neighbours(points.size() - first);
  Nearby peers, coarser;
  for (std::size_t at = 0; at < curve.size(); ++at) {
    const std::uint32_t i = curve[at].second;
    if (i < first) continue;
    peers.clear();
    coarser.clear();
    for (std::size_t k = at - std::min(at, window); k < std::min(at + window + 1, curve.size()); ++k) {
      const std::uint32_t j = curve[k].second;
      if (j < i) (j < first ? coarser : peers).emplace_back(squared_distance(points[i], points[j]), j);
    }
    const std::span found(neighbours[i - first]);
    take_nearest(peers, found.first(peer_count));
    take_nearest(coarser, found.last(coarser_count));
  }
  return neighbours;
}

}  // namespace greenloop::transport
