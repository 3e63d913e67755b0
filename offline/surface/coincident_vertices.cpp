#include "offline/surface/coincident_vertices.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace greenloop::offline {

std::vector<int> first_coincident_vertex(const std::vector<Eigen::Vector3d>& vertices) {
  std::vector<int> order(vertices.size());
  std::iota(order.begin(), order.end(), 0);
  const auto key = [&](int v) { return std::tuple(vertices[v].x(), vertices[v].y(), vertices[v].z(), v); };
  std::sort(order.begin(), order.end(), [&](int a, int b) { return key(a) < key(b); });
  std::vector<int> first(vertices.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && vertices[order[i]] == vertices[order[i - 1]];
    first[order[i]] = same ? first[order[i - 1]] : order[i];
  }
  return first;
}

}  // namespace greenloop::offline
