#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <queue>
#include <span>
#include <stdexcept>
#include <string>

#include "offline/remesh/quadric.hpp"
#include "offline/remesh/self_parameterization.hpp"
#include "offline/remesh/triangle_fans.hpp"
#include "offline/surface/area_and_volume.hpp"

namespace greenloop::offline {
namespace {

/// How much a collapse may spoil the shape, and by what its cost is multiplied if it spoils that much.
struct CollapseRule {
  double least_normal_cosine;  ///< between a triangle's normal before and after
  double least_quality;        ///< 4 sqrt(3) area / sum of squared edges, unless it was worse before
  int least_valence, most_valence;
  double cost_factor;
};
constexpr std::array<CollapseRule, 5> kRules{{{0.3, 0.25, 4, 7, 1},
                                              {0.0, 0.15, 4, 8, 2},
                                              {-0.5, 0.05, 4, 8, 5},
                                              {-2.0, 0.0, 4, 9, 20},
                                              {-2.0, -1.0, 3, std::numeric_limits<int>::max(), 1e3}}};

/// With chains to keep, worse triangles than these allow are not worth fewer vertices.
constexpr std::array<CollapseRule, 2> kFeatureRules{{{0.3, 0.5, 4, 7, 1}, {0.0, 0.4, 4, 8, 3}}};

/// Share of the scatter of area against the quadric error: 0 places base vertices by shape alone.
constexpr double kEvenness = 0.02;

double quality(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const double edges = (b - a).squaredNorm() + (c - b).squaredNorm() + (a - c).squaredNorm();
  return edges > 0 ? 2 * std::sqrt(3.0) * (b - a).cross(c - a).norm() / edges : 0.0;
}

struct Candidate {
  double cost;
  int from, to;
  long stamp;
  std::size_t rule;                               ///< the first that may allow it
  bool operator<(const Candidate& other) const {  // std::priority_queue serves the greatest first
    return std::tuple(other.cost, other.from, other.to) < std::tuple(cost, from, to);
  }
};

/// Edges are flipped from this multiple of the wanted size on.
constexpr double kFlipBelow = 2;
/// What an edge flip weighs: thin triangles and creases, against 2 for each valence that moves away from even.
constexpr double kThinWeight = 2, kCreaseWeight = 4;

class Decimation {
 public:
  Decimation(const TriangleMesh& mesh, const Features& features)
      : positions_(mesh.vertices),
        fans_(mesh.triangles, mesh.vertices.size()),
        planes_(mesh.vertices.size()),
        scatter_(mesh.vertices.size()),
        stamps_(mesh.vertices.size(), 0),
        links_(features, mesh.vertices.size()),
        rules_(features.chains.empty() ? std::span<const CollapseRule>(kRules) : kFeatureRules),
        remaining_(static_cast<int>(mesh.vertices.size())) {
    const double area = surface_area(mesh);
    for (const auto& corners : mesh.triangles) add_triangle(corners, area);
  }

  void run(int target) {
    for (const double share : {8.0, 4.0, 2.8, 2.0, 1.4, 1.0}) {
      const int stage = static_cast<int>(std::lround(share * target));
      collapse_down_to(stage);
      if (remaining_ <= kFlipBelow * target) flip_while_better();
    }
  }

  SelfParameterization result() && {
    SelfParameterization parameterization;
    std::vector<int> renumbered(positions_.size(), -1);
    for (std::size_t v = 0; v < positions_.size(); ++v) {
      if (!fans_.has_vertex(static_cast<int>(v))) continue;
      renumbered[v] = static_cast<int>(parameterization.base_vertices.size());
      parameterization.base_vertices.push_back(positions_[v]);
      parameterization.base_origin.push_back(static_cast<int>(v));
      parameterization.base_planes.push_back(1 / scatter_[v].a(0, 0) * planes_[v]);
    }
    for (int t = 0; t < static_cast<int>(fans_.triangles()); ++t) {
      if (!fans_.has_triangle(t)) continue;
      const auto& [a, b, c] = fans_.corners(t);
      parameterization.base_triangles.push_back({renumbered[a], renumbered[b], renumbered[c]});
      parameterization.base_ids.push_back(t);
    }
    parameterization.changes = std::move(changes_);
    parameterization.base_features = links_.features(renumbered, parameterization.base_vertices);
    return parameterization;
  }

 private:
  void add_triangle(const std::array<int, 3>& corners, double whole_area) {
    const auto& [a, b, c] = corners;
    const Eigen::Vector3d normal = (positions_[b] - positions_[a]).cross(positions_[c] - positions_[a]);
    const double area = normal.norm() / 2;
    const Eigen::Vector3d n = normal.stableNormalized();
    // a sliver must not make the system singular
    const double weight = area / whole_area / 3 + 1e-12 / static_cast<double>(fans_.triangles());
    for (const int v : corners) {
      planes_[v] += Quadric::to_plane(weight, n, n.dot(positions_[a]));
      scatter_[v] += Quadric::to_point(weight, positions_[v]);
    }
  }

  [[nodiscard]] Quadric cost_of(int v) const { return planes_[v] + kEvenness * scatter_[v]; }

  /// Which end of an edge goes into which, and where the other then is.
  struct Merge {
    int from, to;
    Eigen::Vector3d place;
  };

  /// Free ends meet where the shape is kept best, others at the end that must stay; nothing where neither may go.
  [[nodiscard]] std::optional<Merge> merge_of(int low, int high) const {
    const Quadric joint = cost_of(low) + cost_of(high);
    if (links_.is_free(low) && links_.is_free(high)) return Merge{low, high, joint.minimizer()};
    const bool low_goes = links_.may_collapse(low, high), high_goes = links_.may_collapse(high, low);
    if (!low_goes && !high_goes) return std::nullopt;
    if (low_goes && (!high_goes || joint.at(positions_[high]) <= joint.at(positions_[low]))) {
      return Merge{low, high, positions_[high]};
    }
    return Merge{high, low, positions_[low]};
  }

  void push(int v, int w) {
    const auto merge = merge_of(std::min(v, w), std::max(v, w));
    if (!merge) return;
    const auto& [from, to, place] = *merge;
    const Quadric of_from = cost_of(from), of_to = cost_of(to), joint = of_from + of_to;
    const double cost = joint.at(place) - of_from.at(positions_[from]) - of_to.at(positions_[to]);
    queue_.push({std::max(cost, 1e-15), from, to, stamps_[from] + stamps_[to], 0});
  }

  void collapse_down_to(int target) {
    queue_ = {};
    for (std::size_t v = 0; v < positions_.size(); ++v) {
      for (const int w : fans_.neighbors(static_cast<int>(v))) {
        if (static_cast<int>(v) < w) push(static_cast<int>(v), w);
      }
    }
    while (remaining_ > target && !queue_.empty()) {
      Candidate candidate = queue_.top();
      queue_.pop();
      if (!fans_.has_vertex(candidate.from) || !fans_.has_vertex(candidate.to) ||
          candidate.stamp != stamps_[candidate.from] + stamps_[candidate.to]) {
        continue;
      }
      if (!collapse(candidate.from, candidate.to, rules_[candidate.rule])) {
        if (candidate.rule + 1 == rules_.size()) continue;
        ++candidate.rule;
        candidate.cost *= rules_[candidate.rule].cost_factor / rules_[candidate.rule - 1].cost_factor;
        queue_.push(candidate);
        continue;
      }
      // whatever was refused near here may be allowed now
      const auto ring = fans_.neighbors(candidate.to);
      for (const int v : ring) ++stamps_[v];
      ++stamps_[candidate.to];
      for (const int v : ring) {
        for (const int w : fans_.neighbors(v)) {
          if (v < w || !std::binary_search(ring.begin(), ring.end(), w)) push(v, w);
        }
      }
    }
  }

  /// Collapses `from` into `to`; false, and nothing changed, where the rule or the topology forbids it.
  bool collapse(int from, int to, const CollapseRule& rule) {
    const auto shared = fans_.common_neighbors(from, to);
    if (shared.size() != 2 || remaining_ <= 4) return false;
    const int merged_valence = fans_.valence(from) + fans_.valence(to) - 4;
    if (merged_valence < rule.least_valence || merged_valence > rule.most_valence) return false;
    for (const int side : shared) {
      if (fans_.valence(side) - 1 < rule.least_valence) return false;
    }
    const bool free = links_.is_free(from) && links_.is_free(to);
    if (!free && !links_.may_collapse(from, to)) return false;
    if (makes_ear(from, to)) return false;
    const auto patch = patch_of(from, to, free ? (cost_of(from) + cost_of(to)).minimizer() : positions_[to]);
    if (!allowed(patch, rule)) return false;
    auto flat = free ? flatten(patch) : flatten_onto_second(patch);
    if (!flat) return false;
    changes_.push_back(std::move(*flat));
    apply(from, to, patch.vertices.back());
    links_.collapse(from, to);
    planes_[to] += planes_[from];
    scatter_[to] += scatter_[from];
    return true;
  }

  /// A triangle with two edges on chains would be flattened where they run on smoothly: at a vertex inside a chain, or
  /// a corner at which they turn little.
  [[nodiscard]] bool is_ear(const std::array<int, 3>& corners, const std::array<bool, 3>& on_chain) const {
    constexpr double kWidest = -0.5;  // the cosine of 120 degrees
    for (int c = 0; c < 3; ++c) {
      if (!on_chain[c] || !on_chain[(c + 2) % 3]) continue;
      if (!links_.is_corner(corners[c])) return true;
      const Eigen::Vector3d u = positions_[corners[(c + 1) % 3]] - positions_[corners[c]];
      const Eigen::Vector3d v = positions_[corners[(c + 2) % 3]] - positions_[corners[c]];
      if (u.dot(v) < kWidest * u.norm() * v.norm()) return true;
    }
    return false;
  }

  [[nodiscard]] bool makes_ear(int from, int to) const {
    if (links_.is_free(to)) return false;
    const int other = links_.is_free(from) ? -1 : links_.beyond(from, to);
    const auto linked = [&](int v, int w) {
      return links_.chain(v, w) >= 0 || (other >= 0 && std::minmax(v, w) == std::minmax(to, other));
    };
    for (const int start : {from, to}) {
      for (const int t : fans_.around(start)) {
        auto corners = fans_.corners(t);
        std::replace(corners.begin(), corners.end(), from, to);
        const auto& [a, b, c] = corners;
        if (a == b || b == c || c == a) continue;
        if (is_ear(corners, {linked(a, b), linked(b, c), linked(c, a)})) return true;
      }
    }
    return false;
  }

  [[nodiscard]] bool is_ear(int a, int b, int c) const {
    const auto linked = [&](int v, int w) { return links_.chain(v, w) >= 0; };
    return is_ear({a, b, c}, {linked(a, b), linked(b, c), linked(c, a)});
  }

  [[nodiscard]] CollapsePatch patch_of(int from, int to, const Eigen::Vector3d& merged) const {
    std::vector<int> triangles = fans_.around(from);
    for (const int t : fans_.around(to)) {
      if (std::find(triangles.begin(), triangles.end(), t) == triangles.end()) triangles.push_back(t);
    }
    const auto inner = [&](int v) { return v == from || v == to; };
    std::vector<std::array<int, 2>> rim;
    for (const int t : triangles) {
      for (int e = 0; e < 3; ++e) {
        const int a = fans_.corners(t)[e], b = fans_.corners(t)[(e + 1) % 3];
        if (!inner(a) && !inner(b)) rim.push_back({a, b});
      }
    }
    for (std::size_t k = 0; k + 1 < rim.size(); ++k) {
      const auto next =
          std::find_if(rim.begin() + k + 1, rim.end(), [&](const auto& edge) { return edge[0] == rim[k][1]; });
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
    if (!links_.is_free(from)) patch.line = index(links_.beyond(from, to));
    for (const int t : triangles) {
      PatchTriangle triangle{t, {index(fans_.corners(t)[0]), index(fans_.corners(t)[1]), index(fans_.corners(t)[2])}};
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
    fans_.collapse(from, to);
    positions_[to] = merged;
    --remaining_;
  }

  void flip_while_better() {
    constexpr int kPasses = 10;
    bool flipped = true;
    for (int pass = 0; pass < kPasses && flipped; ++pass) {
      flipped = false;
      for (int v = 0; v < static_cast<int>(positions_.size()); ++v) {
        for (const int w : fans_.neighbors(v)) {
          if (v < w && flip(v, w)) flipped = true;
        }
      }
    }
  }

  /// Exchanges the edge (v, w) for the other diagonal of its two triangles if that serves valence and shape.
  bool flip(int v, int w) {
    const auto [left, right] = fans_.sides(v, w);
    const int above = fans_.following(left, w), below = fans_.following(right, v);
    if (links_.chain(v, w) != CurvePoint::kFree) return false;
    if (fans_.valence(v) < 5 || fans_.valence(w) < 5 || fans_.common_neighbors(v, w).size() != 2) return false;
    const auto ring = fans_.neighbors(above);
    if (std::binary_search(ring.begin(), ring.end(), below)) return false;
    if (is_ear(above, v, below) || is_ear(below, w, above)) return false;
    const double now = unevenness(v, w, above) + unevenness(w, v, below) + crease(v, w, above, below);
    const double then = unevenness(above, v, below) + unevenness(below, w, above) + crease(above, below, w, v);
    const double valences =
        2.0 * (fans_.valence(above) + fans_.valence(below) - fans_.valence(v) - fans_.valence(w) + 2);
    if (!(then + valences < now - 1e-9)) return false;

    const auto flat = flattened_quad(v, w, above, below);
    const auto& [at_v, at_w, at_above, at_below] = flat;
    FlatPatch patch;
    for (const int t : {left, right}) {
      FlatTriangle triangle{t, {}};
      for (int c = 0; c < 3; ++c) {
        const int corner = fans_.corners(t)[c];
        triangle.corners[c] = corner == v ? at_v : corner == w ? at_w : corner == above ? at_above : at_below;
      }
      patch.before.push_back(triangle);
    }
    patch.after = {{left, {at_above, at_v, at_below}}, {right, {at_below, at_w, at_above}}};
    changes_.push_back(std::move(patch));
    fans_.flip(v, w);
    return true;
  }

  /// Where the quad v, below, w, above lies in the plane: unfolded if that is convex, a square otherwise.
  [[nodiscard]] std::array<Eigen::Vector2d, 4> flattened_quad(int v, int w, int above, int below) const {
    const double length = (positions_[w] - positions_[v]).norm();
    const Eigen::Vector3d along = (positions_[w] - positions_[v]) / length;
    const auto unfolded = [&](int apex) {
      const Eigen::Vector3d u = positions_[apex] - positions_[v];
      return Eigen::Vector2d(u.dot(along), u.cross(along).norm());
    };
    const Eigen::Vector2d up = unfolded(above), down = unfolded(below).cwiseProduct(Eigen::Vector2d(1, -1));
    const double share = up.y() / (up.y() - down.y());
    const double crossing = up.x() + share * (down.x() - up.x());
    if (crossing > 0.05 * length && crossing < 0.95 * length && share > 0.02 && share < 0.98) {
      return {Eigen::Vector2d(0, 0), Eigen::Vector2d(length, 0), up, down};
    }
    return {Eigen::Vector2d(-1, 0), Eigen::Vector2d(1, 0), Eigen::Vector2d(0, 1), Eigen::Vector2d(0, -1)};
  }

  [[nodiscard]] double unevenness(int a, int b, int c) const {
    return kThinWeight / std::max(quality(positions_[a], positions_[b], positions_[c]), 1e-3);
  }

  /// How far the triangles on both sides of the edge (a, b) are from one plane.
  [[nodiscard]] double crease(int a, int b, int left, int right) const {
    const auto& p = positions_;
    const Eigen::Vector3d m = (p[b] - p[a]).cross(p[left] - p[a]).stableNormalized();
    const Eigen::Vector3d n = (p[right] - p[a]).cross(p[b] - p[a]).stableNormalized();
    return kCreaseWeight * (1 - m.dot(n));
  }

  std::vector<Eigen::Vector3d> positions_;
  TriangleFans fans_;
  std::vector<Quadric> planes_, scatter_;  ///< of all the input area that a vertex stands for
  std::vector<long> stamps_;               ///< raised whenever a vertex or its ring changes: older candidates are void
  std::priority_queue<Candidate> queue_;
  std::vector<FlatPatch> changes_;
  FeatureLinks links_;
  std::span<const CollapseRule> rules_;  ///< mildest first
  int remaining_;
};

}  // namespace

SelfParameterization decimate(const TriangleMesh& mesh, int base_vertices, const Features& features) {
  Decimation decimation(mesh, features);
  decimation.run(base_vertices);
  return std::move(decimation).result();
}

}  // namespace greenloop::offline
