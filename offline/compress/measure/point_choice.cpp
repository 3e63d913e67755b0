#include "offline/compress/measure/point_choice.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

namespace greenloop::offline {

std::vector<std::size_t> farthest_points(const std::vector<Eigen::Vector3d>& points, std::size_t count) {
  std::vector<double> distance(points.size(), std::numeric_limits<double>::infinity());
  std::vector<std::size_t> chosen;
  std::size_t next = 0;
  while (chosen.size() < std::min(count, points.size())) {
    chosen.push_back(next);
    for (std::size_t i = 0; i < points.size(); ++i) {
      distance[i] = std::min(distance[i], (points[i] - points[next]).squaredNorm());
    }
    next = static_cast<std::size_t>(std::max_element(distance.begin(), distance.end()) - distance.begin());
  }
  return chosen;
}

std::vector<std::size_t> nearest_points(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& place,
                                        std::size_t count) {
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto distance = [&](std::size_t i) { return (points[i] - place).squaredNorm(); };
  const auto end = order.begin() + static_cast<std::ptrdiff_t>(std::min(count, order.size()));
  std::partial_sort(order.begin(), end, order.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(distance(a), a) < std::pair(distance(b), b);
  });
  order.erase(end, order.end());
  return order;
}

}  // namespace greenloop::offline
