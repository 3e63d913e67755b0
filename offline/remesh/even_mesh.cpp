#include "offline/remesh/even_mesh.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <numbers>
#include <utility>

#include "offline/remesh/triangle_fans.hpp"
#include "offline/remesh/triangle_tree.hpp"
#include "offline/surface/area_and_volume.hpp"

namespace greenloop::offline {
namespace {

/// The cosine by which a triangle may turn: little while the triangles are coarse, for what is flat needs no more.
constexpr double kFlat = 0.97, kBent = 0.5;
/// Of the length wanted, what each round splits down to: short edges of needles go before their long ones multiply.
constexpr std::array kRounds{16.0, 8.0, 4.0, 2.0, 1.0, 1.0, 1.0, 1.0};
constexpr double kLongest = 4.0 / 3, kShortest = 4.0 / 5;  ///< edges, of the length wanted
constexpr double kNeedle = 1e-3;       ///< sine of an angle below which a triangle's own normal is not believed
constexpr double kStep = 0.7;          ///< of the way to the centre of the neighbours
constexpr double kShorter = 0.99;      ///< of an edge, at most, that its halves may be
constexpr double kMostTriangles = 16;  ///< times those wanted, beside four times those given

/// A bound that no surface whose splits shorten edges comes near to, triangles that are gone again counted.
std::size_t most_triangles(const TriangleMesh& mesh, double edge_length) {
  const double wanted = surface_area(mesh) * 4 / std::sqrt(3.0) / (edge_length * edge_length);
  return 4 * mesh.triangles.size() + static_cast<std::size_t>(kMostTriangles * wanted);
}

class Evening {
 public:
  Evening(const Surface& original, const Features& features, const FeatureCurves& curves, double edge_length)
      : original_(original),
        curves_(curves),
        tree_(original.mesh()),
        length_(edge_length),
        most_triangles_(most_triangles(original.mesh(), edge_length)),
        positions_(original.mesh().vertices),
        fans_(original.mesh().triangles, positions_.size()),
        places_(positions_.size()),
        links_(features, positions_.size()) {
    for (int t = 0; t < static_cast<int>(fans_.triangles()); ++t) {
      for (int c = 0; c < 3; ++c) {
        const int v = fans_.corners(t)[c];
        places_[v].point = {t, Eigen::Vector3d::Unit(c)};
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
      if (gave_up()) return;
      flip_edges();
      collapse_short_edges();
      flip_edges();
      smooth();
    }
    flip_edges();
  }

  EvenMesh result() const {
    EvenMesh even;
    even.settled = !gave_up();
    std::vector<int> renumbered(positions_.size(), -1);
    for (std::size_t v = 0; v < positions_.size(); ++v) {
      if (!fans_.has_vertex(static_cast<int>(v))) continue;
      renumbered[v] = static_cast<int>(even.mesh.vertices.size());
      even.mesh.vertices.push_back(positions_[v]);
      even.origin.push_back(places_[v]);
    }
    for (int t = 0; t < static_cast<int>(fans_.triangles()); ++t) {
      const auto& [a, b, c] = fans_.corners(t);
      if (fans_.has_triangle(t)) even.mesh.triangles.push_back({renumbered[a], renumbered[b], renumbered[c]});
    }
    even.features = links_.features(renumbered, even.mesh.vertices);
    return even;
  }

 private:
  [[nodiscard]] bool gave_up() const { return fans_.triangles() > most_triangles_; }

  [[nodiscard]] double distance(int v, int w) const { return (positions_[v] - positions_[w]).norm(); }

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
      for (int t = 0; t < static_cast<int>(fans_.triangles()); ++t) {
        if (gave_up()) return;
        if (!fans_.has_triangle(t)) continue;
        for (int e = 0; e < 3; ++e) {
          const int v = fans_.corners(t)[e], w = fans_.corners(t)[(e + 1) % 3];
          const bool bare_chain = links_.is_corner(v) && links_.is_corner(w) && links_.chain(v, w) >= 0;
          if (!bare_chain && distance(v, w) <= longest) continue;
          if (!is_longest(t, e) && !bare_chain) continue;
          if (!split(v, w)) continue;
          any = true;
          break;
        }
      }
    }
  }

  [[nodiscard]] bool is_longest(int t, int e) const {
    const auto& c = fans_.corners(t);
    const double here = distance(c[e], c[(e + 1) % 3]);
    return here >= distance(c[(e + 1) % 3], c[(e + 2) % 3]) && here >= distance(c[(e + 2) % 3], c[e]);
  }

  /// False, and nothing changed, where the surface between the ends is too far away for shorter edges.
  bool split(int v, int w) {
    const auto at = halfway(v, w);
    const Eigen::Vector3d middle_place = original_.position(at.point);
    const double farther = std::max((middle_place - positions_[v]).norm(), (middle_place - positions_[w]).norm());
    if (farther > kShorter * distance(v, w)) return false;
    const int middle = fans_.split(v, w);
    links_.split(v, w, middle);
    positions_.emplace_back();
    places_.emplace_back();
    place(middle, at);
    return true;
  }

  void collapse_short_edges() {
    for (int v = 0; v < static_cast<int>(positions_.size()); ++v) {
      bool collapsed = true;
      while (collapsed && fans_.has_vertex(v)) {
        collapsed = false;
        for (const int w : fans_.neighbors(v)) {
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
    if (!links_.may_collapse(removed, kept) || fans_.common_neighbors(removed, kept).size() != 2) return false;
    if (!links_.is_free(removed) && ends_at_corners(removed)) return false;
    for (const int u : fans_.neighbors(removed)) {
      if (u != kept && distance(u, kept) > std::max(kLongest * length_, distance(u, removed))) return false;
    }
    if (!keeps_orientation(removed, positions_[kept], kept)) return false;
    for (const int side : fans_.common_neighbors(removed, kept)) {
      if (fans_.valence(side) < 4) return false;
    }
    fans_.collapse(removed, kept);
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
    for (const int t : fans_.around(v)) around += cross(fans_.corners(t)[0], fans_.corners(t)[1], fans_.corners(t)[2]);
    for (const int t : fans_.around(v)) {
      const int b = fans_.following(t, v), c = fans_.following(t, b);
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
      for (int t = 0; t < static_cast<int>(fans_.triangles()); ++t) {
        for (int e = 0; e < 3 && fans_.has_triangle(t); ++e) {
          if (flip(fans_.corners(t)[e], fans_.corners(t)[(e + 1) % 3])) flipped = true;
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
    const auto [left, right] = fans_.sides(v, w);
    const int above = fans_.following(left, w), below = fans_.following(right, v);
    if (angle(above, v, w) + angle(below, v, w) < std::numbers::pi + 1e-6) return false;
    if (fans_.valence(v) < 4 || fans_.valence(w) < 4) return false;
    const auto ring = fans_.neighbors(above);
    if (std::binary_search(ring.begin(), ring.end(), below)) return false;
    const Eigen::Vector3d now = cross(v, w, above) + cross(w, v, below);
    const Eigen::Vector3d first = cross(above, v, below), second = cross(below, w, above);
    const double least = std::max(flattest_, 0.7) * now.norm();
    if (first.dot(now) < least * first.norm() || second.dot(now) < least * second.norm()) return false;
    fans_.flip(v, w);
    return true;
  }

  void smooth() {
    for (int v = 0; v < static_cast<int>(positions_.size()); ++v) {
      if (!fans_.has_vertex(v) || links_.is_corner(v)) continue;
      const auto at = links_.is_free(v) ? centred(v) : centred_on_chain(v);
      if (keeps_orientation(v, original_.position(at.point))) place(v, at);
    }
  }

  [[nodiscard]] BoundPoint centred(int v) const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double weight = 0;
    for (const int t : fans_.around(v)) {
      const auto& [a, b, c] = fans_.corners(t);
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
  std::size_t most_triangles_;
  double flattest_ = kFlat;
  std::vector<Eigen::Vector3d> positions_;
  TriangleFans fans_;
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
