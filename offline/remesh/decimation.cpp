#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <queue>
#include <stdexcept>
#include <string>

#include "offline/remesh/quadric.hpp"
#include "offline/remesh/self_parameterization.hpp"

namespace greenloop::offline {
namespace {

/// How much shape a collapse may spoil; each next rule is tried only when the one before allows no collapse.
struct CollapseRule {
  double least_normal_cosine;  ///< between a triangle's normal before and after
  double least_quality;        ///< 4 sqrt(3) area / sum of squared edges, unless it was worse before
  int least_valence, most_valence;
};
constexpr std::array<CollapseRule, 5> kRules{{{0.3, 0.2, 4, 8},
                                              {0.0, 0.1, 4, 8},
                                              {-0.7, 0.02, 4, 9},
                                              {-2.0, 0.0, 4, 10},
                                              {-2.0, -1.0, 3, std::numeric_limits<int>::max()}}};

/// Share of the scatter of area against the quadric error: 0 places base vertices by shape alone.
const double kEvenness = getenv("EV")?atof(getenv("EV")):0.1;

double quality(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const double edges = (b - a).squaredNorm() + (c - b).squaredNorm() + (a - c).squaredNorm();
  return edges > 0 ? 2 * std::sqrt(3.0) * (b - a).cross(c - a).norm() / edges : 0.0;
}

struct Candidate {
  double cost;
  int from, to;
  long stamp;
  bool operator<(const Candidate& other) const {  // std::priority_queue serves the greatest first
    return std::tuple(other.cost, other.from, other.to) < std::tuple(cost, from, to);
  }
};

class Decimation {
 public:
  explicit Decimation(const TriangleMesh& mesh)
      : positions_(mesh.vertices),
        corners_(mesh.triangles),
        alive_(mesh.triangles.size(), 1),
        around_(mesh.vertices.size()),
        planes_(mesh.vertices.size()),
        scatter_(mesh.vertices.size()),
        stamps_(mesh.vertices.size(), 0),
        remaining_(static_cast<int>(mesh.vertices.size())) {
    double area = 0;
    for (const auto& [a, b, c] : mesh.triangles) {
      area += (positions_[b] - positions_[a]).cross(positions_[c] - positions_[a]).norm() / 2;
    }
    for (std::size_t t = 0; t < corners_.size(); ++t) add_triangle(static_cast<int>(t), area);
  }

  void run(int target) {
    for (const auto& rule : kRules) {
      collapse_while_allowed(rule, target);
      if (remaining_ <= target) return;
    }
  }

  SelfParameterization result() && {
    SelfParameterization parameterization;
    std::vector<int> renumbered(positions_.size(), -1);
    for (std::size_t v = 0; v < positions_.size(); ++v) {
      if (around_[v].empty()) continue;
      renumbered[v] = static_cast<int>(parameterization.base_vertices.size());
      parameterization.base_vertices.push_back(positions_[v]);
      parameterization.base_planes.push_back(1 / scatter_[v].a(0, 0) * planes_[v]);
    }
    for (std::size_t t = 0; t < corners_.size(); ++t) {
      if (!alive_[t]) continue;
      const auto& [a, b, c] = corners_[t];
      parameterization.base_triangles.push_back({renumbered[a], renumbered[b], renumbered[c]});
      parameterization.base_ids.push_back(static_cast<int>(t));
    }
    parameterization.collapses = std::move(collapses_);
    return parameterization;
  }

 private:
  void add_triangle(int t, double whole_area) {
    const auto& [a, b, c] = corners_[t];
    const Eigen::Vector3d normal = (positions_[b] - positions_[a]).cross(positions_[c] - positions_[a]);
    const double area = normal.norm() / 2;
    const Eigen::Vector3d n = normal.stableNormalized();
    // a sliver must not make the system singular
    const double weight = area / whole_area / 3 + 1e-12 / static_cast<double>(corners_.size());
    for (const int v : corners_[t]) {
      around_[v].push_back(t);
      planes_[v] += Quadric::to_plane(weight, n, n.dot(positions_[a]));
      scatter_[v] += Quadric::to_point(weight, positions_[v]);
    }
  }

  [[nodiscard]] int valence(int v) const { return static_cast<int>(around_[v].size()); }

  /// Neighbours in increasing order.
  [[nodiscard]] std::vector<int> neighbors(int v) const {
    std::vector<int> found;
    for (const int t : around_[v]) {
      for (const int w : corners_[t]) {
        if (w != v) found.push_back(w);
      }
    }
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
  }

  [[nodiscard]] Quadric cost_of(int v) const { return planes_[v] + kEvenness * scatter_[v]; }

  void push(int v, int w) {
    const int from = std::min(v, w), to = std::max(v, w);
    const Quadric of_from = cost_of(from), of_to = cost_of(to), joint = of_from + of_to;
    const double cost = joint.at(joint.minimizer()) - of_from.at(positions_[from]) - of_to.at(positions_[to]);
    queue_.push({cost, from, to, stamps_[from] + stamps_[to]});
  }

  void collapse_while_allowed(const CollapseRule& rule, int target) {
    queue_ = {};
    for (std::size_t v = 0; v < positions_.size(); ++v) {
      for (const int w : neighbors(static_cast<int>(v))) {
        if (static_cast<int>(v) < w) push(static_cast<int>(v), w);
      }
    }
    while (remaining_ > target && !queue_.empty()) {
      const Candidate candidate = queue_.top();
      queue_.pop();
      if (around_[candidate.from].empty() || around_[candidate.to].empty() ||
          candidate.stamp != stamps_[candidate.from] + stamps_[candidate.to]) {
        continue;
      }
      if (!collapse(candidate.from, candidate.to, rule)) continue;
      // whatever was refused near here may be allowed now
      const auto ring = neighbors(candidate.to);
      for (const int v : ring) ++stamps_[v];
      ++stamps_[candidate.to];
      for (const int v : ring) {
        for (const int w : neighbors(v)) {
          if (v < w || !std::binary_search(ring.begin(), ring.end(), w)) push(v, w);
        }
      }
    }
  }

  /// Collapses `from` into `to`; false, and nothing changed, where the rule or the topology forbids it.
  bool collapse(int from, int to, const CollapseRule& rule) {
    const auto shared = common_neighbors(from, to);
    if (shared.size() != 2 || remaining_ <= 4) return false;
    const int merged_valence = valence(from) + valence(to) - 4;
    if (merged_valence < rule.least_valence || merged_valence > rule.most_valence) return false;
    for (const int side : shared) {
      if (valence(side) - 1 < rule.least_valence) return false;
    }
    const auto patch = patch_of(from, to, (cost_of(from) + cost_of(to)).minimizer());
    if (!allowed(patch, rule)) return false;
    auto flat = flatten(patch);
    if (!flat) return false;
    collapses_.push_back(std::move(*flat));
    apply(from, to, patch.vertices.back());
    planes_[to] += planes_[from];
    scatter_[to] += scatter_[from];
    return true;
  }

  [[nodiscard]] std::vector<int> common_neighbors(int v, int w) const {
    const auto of_v = neighbors(v), of_w = neighbors(w);
    std::vector<int> common;
    std::set_intersection(of_v.begin(), of_v.end(), of_w.begin(), of_w.end(), std::back_inserter(common));
    return common;
  }

  [[nodiscard]] CollapsePatch patch_of(int from, int to, const Eigen::Vector3d& merged) const {
    std::vector<int> triangles = around_[from];
    for (const int t : around_[to]) {
      if (std::find(triangles.begin(), triangles.end(), t) == triangles.end()) triangles.push_back(t);
    }
    const auto inner = [&](int v) { return v == from || v == to; };
    std::vector<std::array<int, 2>> rim;
    for (const int t : triangles) {
      for (int e = 0; e < 3; ++e) {
        const int a = corners_[t][e], b = corners_[t][(e + 1) % 3];
        if (!inner(a) && !inner(b)) rim.push_back({a, b});
      }
    }
    for (std::size_t k = 0; k + 1 < rim.size(); ++k) {
      const auto next = std::find_if(rim.begin() + k + 1, rim.end(), [&](const auto& edge) { return edge[0] == rim[k][1]; });
      std::iter_swap(rim.begin() + k + 1, next);
    }
    CollapsePatch patch;
    patch.outline = static_cast<int>(rim.size());
    for (const auto& edge : rim) patch.vertices.push_back(positions_[edge[0]]);
    patch.vertices.insert(patch.vertices.end(), {positions_[from], positions_[to], merged});
    const auto index = [&](int v) {
      if (v == from) return patch.outline;
      if (v == to) return patch.outline + 1;
      for (int k = 0; k < patch.outline; ++k) {
        if (rim[k][0] == v) return k;
      }
      throw std::logic_error("decimation: vertex " + std::to_string(v) + " is missing from the outline of its patch");
    };
    for (const int t : triangles) {
      PatchTriangle triangle{t, {index(corners_[t][0]), index(corners_[t][1]), index(corners_[t][2])}};
      patch.before.push_back(triangle);
      int inner_corners = 0;
      for (int& corner : triangle.corners) {
        if (corner < patch.outline) continue;
        corner = patch.outline + 2;
        ++inner_corners;
      }
      if (inner_corners == 1) patch.after.push_back(triangle);
    }
    return patch;
  }

  [[nodiscard]] static bool allowed(const CollapsePatch& patch, const CollapseRule& rule) {
    for (const auto& after : patch.after) {
      const auto before = std::find_if(patch.before.begin(), patch.before.end(),
                                       [&](const PatchTriangle& t) { return t.triangle == after.triangle; });
      const auto corner = [&](const PatchTriangle& t, int c) -> const Eigen::Vector3d& {
        return patch.vertices[t.corners[c]];
      };
      const auto normal = [&](const PatchTriangle& t) {
        return (corner(t, 1) - corner(t, 0)).cross(corner(t, 2) - corner(t, 0)).stableNormalized().eval();
      };
      if (normal(after).dot(normal(*before)) < rule.least_normal_cosine) return false;
      const double reached = quality(corner(after, 0), corner(after, 1), corner(after, 2));
      const double had = quality(corner(*before, 0), corner(*before, 1), corner(*before, 2));
      if (reached < std::min(rule.least_quality, had)) return false;
    }
    return true;
  }

  void apply(int from, int to, const Eigen::Vector3d& merged) {
    for (const int t : around_[from]) {
      auto& corners = corners_[t];
      if (std::find(corners.begin(), corners.end(), to) != corners.end()) {
        alive_[t] = 0;
        for (const int v : corners) {
          if (v != from) std::erase(around_[v], t);
        }
      } else {
        std::replace(corners.begin(), corners.end(), from, to);
        around_[to].push_back(t);
      }
    }
    around_[from].clear();
    positions_[to] = merged;
    --remaining_;
  }

  std::vector<Eigen::Vector3d> positions_;
  std::vector<std::array<int, 3>> corners_;
  std::vector<char> alive_;
  std::vector<std::vector<int>> around_;  ///< triangles around each vertex; empty once it is gone
  std::vector<Quadric> planes_, scatter_;  ///< of all the input area that a vertex stands for
  std::vector<long> stamps_;  ///< raised whenever a vertex or its ring changes: older candidates are void
  std::priority_queue<Candidate> queue_;
  std::vector<FlatPatch> collapses_;
  int remaining_;
};

}  // namespace

SelfParameterization decimate(const TriangleMesh& mesh, int base_vertices) {
  Decimation decimation(mesh);
  decimation.run(base_vertices);
  return std::move(decimation).result();
}

}  // namespace greenloop::offline
