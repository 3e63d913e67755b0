#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace greenloop::transport {

/// A point on a grid of 2^16 steps from the origin to the largest coordinate there is, in every direction.
using GridPoint = std::array<std::int32_t, 3>;

[[nodiscard]] std::uint64_t squared_distance(const GridPoint& a, const GridPoint& b);

inline constexpr std::uint32_t no_neighbour = 0xffffffff;
inline constexpr std::size_t peer_count = 6, coarser_count = 2, neighbour_count = peer_count + coarser_count;
using Neighbours = std::array<std::uint32_t, neighbour_count>;

/// For every point from `first` on: those near to it among the points from `first` on that lie before it, peer_count of
/// them, the nearest first; then among the points before `first`, coarser_count of them. no_neighbour where there are
/// not enough. Sought among the 128 to either side on a space-filling curve, so that the work is linear in the points.
[[nodiscard]] std::vector<Neighbours> neighbours_before(std::span<const GridPoint> points, std::size_t first = 0);

}  // namespace greenloop::transport
