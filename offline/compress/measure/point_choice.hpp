#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace greenloop::offline {

/// At most `count` of the points [m], by number, the first one first, each as far from those before as can be
/// (farthest-point sampling, Gonzalez 1985). Work: count passes over the points. Offline only.
[[nodiscard]] std::vector<std::size_t> farthest_points(const std::vector<Eigen::Vector3d>& points, std::size_t count);

/// The `count` points nearest to a place [m], by number, the nearest first; of equally near ones the lower number.
/// Fewer if there are fewer. Offline only.
[[nodiscard]] std::vector<std::size_t> nearest_points(const std::vector<Eigen::Vector3d>& points,
                                                      const Eigen::Vector3d& place, std::size_t count);

}  // namespace greenloop::offline
