#include "offline/remesh/subdivision_connectivity.hpp"

#include <algorithm>
#include <array>
#include <set>
#include <utility>
#include <vector>

#include "offline/remesh/surface.hpp"

namespace greenloop::offline {
namespace {

using Triangles = std::vector<std::array<int, 3>>;

/// An odd vertex and the ends of the coarse edge it splits.
struct Midpoint {
  int vertex;
  std::array<int, 2> parents;
};

/// One 1-to-4 split undone.
struct Unsplit {
  Triangles triangles;  ///< over the same vertex numbers, odd vertices left out
  std::vector<Midpoint> midpoints;
};

/// Splits undone one after the other.
struct Hierarchy {
  Triangles base;
  std::vector<std::vector<Midpoint>> splits;  ///< coarse to fine
  double deviation = 0;                       ///< sum of squared distances of odd vertices from midpoints
};

/// Gives each triangle its role in a split, starting from one middle triangle.
class SplitTracing {
 public:
  SplitTracing(const Triangles& triangles, const Triangles& neighbors)
      : triangles_(triangles), neighbors_(neighbors), role_(triangles.size(), kUnknown) {}

  /// The middle triangles, if every triangle takes exactly one role.
  std::optional<std::vector<int>> trace(int first_middle) {
    std::vector<int> middles{first_middle};
    role_[first_middle] = kMiddle;
    for (std::size_t k = 0; k < middles.size(); ++k) {
      for (const int corner : neighbors_[middles[k]]) {
        if (!assign(corner, apex_facing(corner, middles[k])) || !visit_fan(corner, middles)) return std::nullopt;
      }
    }
    if (4 * middles.size() != triangles_.size()) return std::nullopt;
    return middles;
  }

  /// The corner of `triangle` that is not shared with its neighbour `other`.
  [[nodiscard]] int apex_facing(int triangle, int other) const {
    const auto& across = neighbors_[triangle];
    return static_cast<int>(std::find(across.begin(), across.end(), other) - across.begin() + 2) % 3;
  }

 private:
  static constexpr int kUnknown = -1, kMiddle = 3;

  /// False if the triangle already has another role.
  bool assign(int triangle, int role) {
    if (role_[triangle] == kUnknown) role_[triangle] = role;
    return role_[triangle] == role;
  }

  /// All triangles around the even vertex of a corner triangle are corners of it, each with a middle one behind.
  bool visit_fan(int corner, std::vector<int>& middles) {
    int triangle = corner, apex = role_[corner];
    do {
      const int middle = neighbors_[triangle][(apex + 1) % 3];
      if (role_[middle] == kUnknown) middles.push_back(middle);
      if (!assign(middle, kMiddle)) return false;
      const int next = neighbors_[triangle][apex];
      const int even = triangles_[triangle][apex];
      apex = static_cast<int>(std::find(triangles_[next].begin(), triangles_[next].end(), even) -
                              triangles_[next].begin());
      triangle = next;
      if (!assign(triangle, apex)) return false;
    } while (triangle != corner);
    return true;
  }

  const Triangles& triangles_;
  const Triangles& neighbors_;
  std::vector<int> role_;  ///< of each triangle: middle one, or corner one whose even vertex has this index in it
};

/// The split undone around these middle triangles; nothing if two coarse edges would have the same ends.
std::optional<Unsplit> unsplit(const Triangles& triangles, const Triangles& neighbors,
                               const std::vector<int>& middles) {
  const SplitTracing tracing(triangles, neighbors);
  Unsplit undone;
  std::vector<std::array<int, 3>> edges;  // lower end, higher end, midpoint
  for (const int middle : middles) {
    std::array<int, 3> corners;
    for (int e = 0; e < 3; ++e) {
      const int corner = neighbors[middle][e];
      corners[e] = triangles[corner][tracing.apex_facing(corner, middle)];
    }
    undone.triangles.push_back(corners);
    // the middle triangle's vertex e + 1 lies between the corners beyond its edges e and e + 1
    for (int e = 0; e < 3; ++e) {
      const auto [low, high] = std::minmax(corners[e], corners[(e + 1) % 3]);
      edges.push_back({low, high, triangles[middle][(e + 1) % 3]});
    }
  }
  std::sort(edges.begin(), edges.end());
  std::set<int> odd;
  for (std::size_t k = 0; k < edges.size(); k += 2) {
    const auto [low, high, vertex] = edges[k];
    if (low == high || k + 1 >= edges.size() || edges[k + 1] != edges[k] || !odd.insert(vertex).second) return {};
    if (k + 2 < edges.size() && edges[k + 2][0] == low && edges[k + 2][1] == high) return {};
    undone.midpoints.push_back({vertex, {low, high}});
  }
  return undone;
}

/// The deepest hierarchy of at most `levels` splits.
Hierarchy undo_splits(const Triangles& triangles, int levels, const std::vector<Eigen::Vector3d>& positions) {
  Hierarchy best{triangles, {}, 0};
  if (levels == 0 || triangles.size() % 4 != 0 || triangles.size() < 16) return best;
  const auto neighbors = triangle_neighbors(triangles);
  for (const int middle : {0, neighbors[0][0], neighbors[0][1], neighbors[0][2]}) {
    const auto middles = SplitTracing(triangles, neighbors).trace(middle);
    if (!middles) continue;
    const auto undone = unsplit(triangles, neighbors, *middles);
    if (!undone) continue;
    Hierarchy hierarchy = undo_splits(undone->triangles, levels - 1, positions);
    for (const auto& [vertex, parents] : undone->midpoints) {
      hierarchy.deviation += (positions[vertex] - (positions[parents[0]] + positions[parents[1]]) / 2).squaredNorm();
    }
    hierarchy.splits.push_back(undone->midpoints);
    const bool deeper = hierarchy.splits.size() > best.splits.size();
    const bool as_deep = hierarchy.splits.size() == best.splits.size();
    if (deeper || (as_deep && hierarchy.deviation < best.deviation)) best = std::move(hierarchy);
  }
  return best;
}

}  // namespace

std::optional<SemiRegularMesh> find_subdivision_connectivity(const TriangleMesh& mesh, int most_levels) {
  const Hierarchy hierarchy = undo_splits(mesh.triangles, most_levels, mesh.vertices);
  if (hierarchy.splits.empty()) return std::nullopt;
  SemiRegularMesh found;
  std::vector<int> renumbered(mesh.vertices.size(), -1);
  const auto add = [&](int vertex, std::array<int, 2> parents) {
    renumbered[vertex] = static_cast<int>(found.positions.size());
    found.positions.push_back(mesh.vertices[vertex]);
    found.parents.push_back(parents);
  };
  std::set<int> even;
  for (const auto& corners : hierarchy.base) even.insert(corners.begin(), corners.end());
  for (const int vertex : even) add(vertex, {-1, -1});
  for (const auto& [a, b, c] : hierarchy.base)
    found.base_triangles.push_back({renumbered[a], renumbered[b], renumbered[c]});
  found.vertex_end.push_back(found.positions.size());
  for (const auto& split : hierarchy.splits) {
    for (const auto& [vertex, parents] : split) {
      const auto [low, high] = std::minmax(renumbered[parents[0]], renumbered[parents[1]]);
      add(vertex, {low, high});
    }
    found.vertex_end.push_back(found.positions.size());
  }
  return found;
}

}  // namespace greenloop::offline
