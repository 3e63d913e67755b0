#include "offline/remesh/even_mesh.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <numbers>
#include <utility>

#include "offline/remesh/triangle_tree.hpp"

namespace greenloop::offline {
namespace {

/// The cosine by which a triangle may turn: little while the triangles are coarse, for what is flat needs no more.
constexpr double kFlat = 0.97, kBent = 0.5;
/// Of the length wanted, what each round splits down to: short edges of needles go before their long ones multiply.
constexpr std::array kRounds{16.0, 8.0, 4.0, 2.0, 1.0, 1.0, 1.0, 1.0};
constexpr double kLongest = 4.0 / 3, kShortest = 4.0 / 5;  ///< edges, of the length wanted
constexpr double kNeedle = 1e-3;  ///< sine of an angle below which a triangle's own normal is not believed
constexpr double kStep = 0.7;     ///< of the way to the centre of the neighbours

class Evening {
 public:
  Evening(const Surface& original, const Features& features, const FeatureCurves& curves, double edge_length)
      : original_(original),
        curves_(curves),
        tree_(original.mesh()),
        length_(edge_length),
        positions_(original.mesh().vertices),
        corners_(original.mesh().triangles),
        around_(positions_.size()),
        places_(positions_.size()),
        links_(features, positions_.size()) {
    for (std::size_t t = 0; t < corners_.size(); ++t) {
      for (int c = 0; c < 3; ++c) {
        const int v = corners_[t][c];
        around_[v].push_back(static_cast<int>(t));
        places_[v].point = {static_cast<int>(t), Eigen::Vector3d::Unit(c)};
        if (links_.is_corner(v)) places_[v].curve = {CurvePoint::kCorner, 0, v};
      }
    }
    for (std::size_t c = 0; c < features.chains.size(); ++c) {
      const auto& [vertices, lengths, loop] = features.chains[c];
      for (std::size_t k = 0; k < vertices.size(); ++k) {
        if (!links_.is_corner(vertices[k]) && (k == 0 || k + 1 < vertices.size())) {
          places_[vertices[k]].curve = {static_cast<int>(c), lengths[k], -1};
        }
      }
    }
  }

  void run() {
    flip_edges();
    for (const double coarser : kRounds) {
      flattest_ = coarser > 1 ? kFlat : kBent;
      split_long_edges(coarser * kLongest * length_);
      flip_edges();
      collapse_short_edges();
      flip_edges();
      smooth();
    }
    flip_edges();
  }

  EvenMesh result() const {
    EvenMesh even;
    std::vector<int> renumbered(positions_.size(), -1);
    for (std::size_t v = 0; v < positions_.size(); ++v) {
      if (around_[v].empty()) continue;
      renumbered[v] = static_cast<int>(even.mesh.vertices.size());
      even.mesh.vertices.push_back(positions_[v]);
      even.origin.push_back(places_[v]);
    }
    for (const auto& [a, b, c] : corners_) {
      if (a >= 0) even.mesh.triangles.push_back({renumbered[a], renumbered[b], renumbered[c]});
    }
    even.features = links_.features(renumbered, even.mesh.vertices);
    return even;
  }

 private:
  [[nodiscard]] double distance(int v, int w) const { return (positions_[v] - positions_[w]).norm(); }

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

  [[nodiscard]] std::vector<int> common_neighbors(int v, int w) const {
    const auto of_v = neighbors(v), of_w = neighbors(w);
    std::vector<int> common;
    std::set_intersection(of_v.begin(), of_v.end(), of_w.begin(), of_w.end(), std::back_inserter(common));
    return common;
  }

  [[nodiscard]] int following(int t, int v) const {
    const auto& corners = corners_[t];
    return corners[(std::find(corners.begin(), corners.end(), v) - corners.begin() + 1) % 3];
  }

  /// The triangles left and right of the edge from v to w.
  [[nodiscard]] std::array<int, 2> sides(int v, int w) const {
    std::array<int, 2> found{-1, -1};
    for (const int t : around_[v]) {
      if (following(t, v) == w) found[0] = t;
      if (following(t, following(t, v)) == w) found[1] = t;
    }
    return found;
  }

  [[nodiscard]] Eigen::Vector3d cross(int a, int b, int c) const {
    return (positions_[b] - positions_[a]).cross(positions_[c] - positions_[a]);
  }

  void place(int v, const BoundPoint& at) {
    places_[v] = at;
    positions_[v] = original_.position(at.point);
  }

  /// Halfway from v to w: along their chain, or on the surface.
  [[nodiscard]] BoundPoint halfway(int v, int w) const {
    if (links_.chain(v, w) >= 0) return on_chain(middle_of_chain(v, w));
    return {tree_.closest((positions_[v] + positions_[w]) / 2), {}};
  }

  [[nodiscard]] CurvePoint middle_of_chain(int v, int w) const {
    const auto &a = places_[v].curve, &b = places_[w].curve;
    if (!links_.is_corner(v)) return curves_.moved(a, curves_.way(a, b) / 2);
    if (!links_.is_corner(w)) return curves_.moved(b, curves_.way(b, a) / 2);
    const int chain = links_.chain(v, w);
    return {chain, curves_.chains()[chain].lengths.back() / 2, -1};
  }

  [[nodiscard]] BoundPoint on_chain(const CurvePoint& curve) const { return {curves_.point(curve), curve}; }

  void split_long_edges(double longest) {
    bool any = true;
    while (any) {
      any = false;
      for (std::size_t t = 0; t < corners_.size(); ++t) {
        if (corners_[t][0] < 0) continue;
        for (int e = 0; e < 3; ++e) {
          const int v = corners_[t][e], w = corners_[t][(e + 1) % 3];
          const bool bare_chain = links_.is_corner(v) && links_.is_corner(w) && links_.chain(v, w) >= 0;
          if (!bare_chain && distance(v, w) <= longest) continue;
          if (!is_longest(static_cast<int>(t), e) && !bare_chain) continue;
          split(v, w);
          any = true;
          break;
        }
      }
    }
  }

  [[nodiscard]] bool is_longest(int t, int e) const {
    const auto& c = corners_[t];
    const double here = distance(c[e], c[(e + 1) % 3]);
    return here >= distance(c[(e + 1) % 3], c[(e + 2) % 3]) && here >= distance(c[(e + 2) % 3], c[e]);
  }

  void split(int v, int w) {
    const auto [left, right] = sides(v, w);
    const int middle = static_cast<int>(positions_.size());
    const auto at = halfway(v, w);
    links_.split(v, w, middle);
    positions_.emplace_back();
    places_.emplace_back();
    around_.emplace_back();
    place(middle, at);
    for (const int t : {left, right}) {
      const int fresh = static_cast<int>(corners_.size());
      auto other = corners_[t];
      std::replace(corners_[t].begin(), corners_[t].end(), w, middle);
      std::replace(other.begin(), other.end(), v, middle);
      corners_.push_back(other);
      std::replace(around_[w].begin(), around_[w].end(), t, fresh);
      around_[middle].insert(around_[middle].end(), {t, fresh});
      for (const int u : other) {
        if (u != middle && u != w) around_[u].push_back(fresh);
      }
    }
  }

  void collapse_short_edges() {
    for (int v = 0; v < static_cast<int>(positions_.size()); ++v) {
      bool collapsed = true;
      while (collapsed && !around_[v].empty()) {
        collapsed = false;
        for (const int w : neighbors(v)) {
          if (distance(v, w) >= kShortest * length_) continue;
          if (collapse(w, v) || collapse(v, w)) {
            collapsed = true;
            break;
          }
        }
      }
    }
  }

  bool collapse(int removed, int kept) {
    if (!links_.may_collapse(removed, kept) || common_neighbors(removed, kept).size() != 2) return false;
    if (!links_.is_free(removed) && ends_at_corners(removed)) return false;
    for (const int u : neighbors(removed)) {
      if (u != kept && distance(u, kept) > std::max(kLongest * length_, distance(u, removed))) return false;
    }
    if (!keeps_orientation(removed, positions_[kept], kept)) return false;
    for (const int side : common_neighbors(removed, kept)) {
      if (around_[side].size() < 4) return false;
    }
    for (const int t : around_[removed]) {
      auto& corners = corners_[t];
      if (std::find(corners.begin(), corners.end(), kept) != corners.end()) {
        for (const int v : corners) {
          if (v != removed) std::erase(around_[v], t);
        }
        corners = {-1, -1, -1};
      } else {
        std::replace(corners.begin(), corners.end(), removed, kept);
        around_[kept].push_back(t);
      }
    }
    around_[removed].clear();
    links_.collapse(removed, kept);
    return true;
  }

  /// A chain keeps a vertex between its corners: the length along it tells which way it runs.
  [[nodiscard]] bool ends_at_corners(int v) const {
    const auto ends = links_.along(v);
    return links_.is_corner(ends[0]) && links_.is_corner(ends[1]);
  }

  /// Whether the triangles around v, but those with `but`, still look the same way with v at `there`.
  [[nodiscard]] bool keeps_orientation(int v, const Eigen::Vector3d& there, int but = -1) const {
    Eigen::Vector3d around = Eigen::Vector3d::Zero();
    for (const int t : around_[v]) around += cross(corners_[t][0], corners_[t][1], corners_[t][2]);
    for (const int t : around_[v]) {
      const int b = following(t, v), c = following(t, b);
      if (b == but || c == but) continue;
      Eigen::Vector3d before = cross(v, b, c);
      if (before.norm() < kNeedle * distance(v, b) * distance(v, c)) before = around;
      const Eigen::Vector3d after = (positions_[b] - there).cross(positions_[c] - there);
      const double longest = std::max(
          {(positions_[b] - there).squaredNorm(), (positions_[c] - there).squaredNorm(), std::pow(distance(b, c), 2)});
      if (after.dot(before) < flattest_ * after.norm() * before.norm()) return false;
      if (after.norm() < 0.05 * longest && after.norm() < before.norm()) return false;
    }
    return true;
  }

  void flip_edges() {
    constexpr int kPasses = 10;
    bool flipped = true;
    for (int pass = 0; pass < kPasses && flipped; ++pass) {
      flipped = false;
      for (std::size_t t = 0; t < corners_.size(); ++t) {
        for (int e = 0; e < 3 && corners_[t][0] >= 0; ++e) {
          if (flip(corners_[t][e], corners_[t][(e + 1) % 3])) flipped = true;
        }
      }
    }
  }

  [[nodiscard]] double angle(int apex, int a, int b) const {
    const Eigen::Vector3d u = positions_[a] - positions_[apex], v = positions_[b] - positions_[apex];
    return std::atan2(u.cross(v).norm(), u.dot(v));
  }

  /// Exchanges the edge (v, w) for the other diagonal where the angles across it sum to more than a half turn.
  bool flip(int v, int w) {
    if (links_.chain(v, w) >= 0) return false;
    const auto [left, right] = sides(v, w);
    const int above = following(left, w), below = following(right, v);
    if (angle(above, v, w) + angle(below, v, w) < std::numbers::pi + 1e-6) return false;
    if (around_[v].size() < 4 || around_[w].size() < 4) return false;
    const auto ring = neighbors(above);
    if (std::binary_search(ring.begin(), ring.end(), below)) return false;
    const Eigen::Vector3d now = cross(v, w, above) + cross(w, v, below);
    const Eigen::Vector3d first = cross(above, v, below), second = cross(below, w, above);
    const double least = std::max(flattest_, 0.7) * now.norm();
    if (first.dot(now) < least * first.norm() || second.dot(now) < least * second.norm()) return false;
    corners_[left] = {above, v, below};
    corners_[right] = {below, w, above};
    std::erase(around_[v], right);
    std::erase(around_[w], left);
    around_[above].push_back(right);
    around_[below].push_back(left);
    return true;
  }

  void smooth() {
    for (int v = 0; v < static_cast<int>(positions_.size()); ++v) {
      if (around_[v].empty() || links_.is_corner(v)) continue;
      const auto at = links_.is_free(v) ? centred(v) : centred_on_chain(v);
      if (keeps_orientation(v, original_.position(at.point))) place(v, at);
    }
  }

  [[nodiscard]] BoundPoint centred(int v) const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double weight = 0;
    for (const int t : around_[v]) {
      const auto& [a, b, c] = corners_[t];
      const double area = cross(a, b, c).norm();
      sum += area * (positions_[a] + positions_[b] + positions_[c]) / 3;
      weight += area;
    }
    if (!(weight > 0)) return places_[v];
    const Eigen::Vector3d way = sum / weight - positions_[v];
    const Eigen::Vector3d normal = original_.normal(places_[v].point);
    return {original_.walk(places_[v].point, kStep * (way - way.dot(normal) * normal)), {}};
  }

  [[nodiscard]] BoundPoint centred_on_chain(int v) const {
    const auto& here = places_[v].curve;
    double way = 0;
    for (const int w : links_.along(v)) way += curves_.way(here, places_[w].curve) / 2;
    return on_chain(curves_.moved(here, kStep * way));
  }

  const Surface& original_;
  const FeatureCurves& curves_;
  TriangleTree tree_;
  double length_;
  double flattest_ = kFlat;
  std::vector<Eigen::Vector3d> positions_;
  std::vector<std::array<int, 3>> corners_;  ///< of a triangle that is gone, all -1
  std::vector<std::vector<int>> around_;     ///< triangles around each vertex; empty once it is gone
  std::vector<BoundPoint> places_;
  FeatureLinks links_;
};

}  // namespace

/// A point on the edge of a triangle that lies on a chain: by length between the places of the edge's ends.
SurfacePoint EvenMesh::on_chain(const BoundPoint& at, const std::array<int, 3>& corners,
                                const FeatureCurves& original_curves) const {
  const auto& weights = at.point.weights;
  int low = 0;
  weights.minCoeff(&low);
  const int a = corners[(low + 1) % 3], b = corners[(low + 2) % 3];
  const double share = weights[(low + 2) % 3];
  const auto &from = origin[a].curve, &to = origin[b].curve;
  if (share < 1e-12) return origin[a].point;
  if (share > 1 - 1e-12) return origin[b].point;
  const auto place = from.chain >= 0 ? original_curves.moved(from, share * original_curves.way(from, to))
                                     : original_curves.moved(to, (1 - share) * original_curves.way(to, from));
  return original_curves.point(place);
}

SurfacePoint EvenMesh::on_original(const BoundPoint& at, const FeatureCurves& original_curves,
                                   const TriangleTree& tree) const {
  const auto& [triangle, weights] = at.point;
  const auto& corners = mesh.triangles[triangle];
  if (at.curve.chain != CurvePoint::kFree) return on_chain(at, corners, original_curves);
  return tree.closest(weights[0] * mesh.vertices[corners[0]] + weights[1] * mesh.vertices[corners[1]] +
                      weights[2] * mesh.vertices[corners[2]]);
}

EvenMesh even_mesh(const Surface& original, const Features& features, const FeatureCurves& curves, double edge_length) {
  Evening evening(original, features, curves, edge_length);
  evening.run();
  return evening.result();
}

}  // namespace greenloop::offline
