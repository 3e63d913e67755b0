#include "offline/surface/coincident_vertices.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <tuple>
#include <unordered_map>

namespace greenloop::offline {
namespace {

/// Of a grid of cubes.
using Cell = std::array<std::int64_t, 3>;

struct CellHash {
  std::size_t operator()(const Cell& cell) const {
    std::uint64_t hash = 0;
    for (const auto part : cell) {
      hash = (hash ^ static_cast<std::uint64_t>(part)) * 0x9e3779b97f4a7c15;
      hash ^= hash >> 32;
    }
    return hash;
  }
};

Cell cell_of(const Eigen::Vector3d& from_corner, double side) {
  constexpr double most = 1e18;  // whole numbers end a little beyond
  const auto index = [&](double x) { return static_cast<std::int64_t>(std::min(x / side, most)); };
  return {index(from_corner.x()), index(from_corner.y()), index(from_corner.z())};
}

template <typename Visit>
void for_each_neighbour(const Cell& cell, const Visit& visit) {
  for (std::int64_t i = -1; i <= 1; ++i) {
    for (std::int64_t j = -1; j <= 1; ++j) {
      for (std::int64_t k = -1; k <= 1; ++k) {
        visit(Cell{cell[0] + i, cell[1] + j, cell[2] + k});
      }
    }
  }
}

}  // namespace

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

std::vector<int> first_vertex_within(const std::vector<Eigen::Vector3d>& vertices, double distance,
                                     const std::vector<bool>& considered) {
  Eigen::AlignedBox3d box;
  for (const auto& vertex : vertices) {
    box.extend(vertex);
  }
  std::unordered_map<Cell, std::vector<int>, CellHash> kept;  // at most a few a cell: they are `distance` apart
  std::vector<int> target(vertices.size());
  for (int v = 0; v < static_cast<int>(vertices.size()); ++v) {
    target[v] = v;
    if (!considered[v]) {
      continue;
    }
    const Cell cell = cell_of(vertices[v] - box.min(), distance);
    double nearest = distance;
    for_each_neighbour(cell, [&](const Cell& near) {
      const auto it = kept.find(near);
      if (it == kept.end()) {
        return;
      }
      for (const int other : it->second) {
        const double apart = (vertices[other] - vertices[v]).norm();
        if (apart < nearest || (apart == distance && target[v] == v)) {
          nearest = apart;
          target[v] = other;
        }
      }
    });
    if (target[v] == v) {
      kept[cell].push_back(v);
    }
  }
  return target;
}

}  // namespace greenloop::offline
