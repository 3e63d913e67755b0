#include "offline/remesh/feature_curves.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

namespace greenloop::offline {
namespace {

/// A chain that turns by more than this has a corner there.
constexpr double kCornerDegrees = 50;

double cosine(double degrees) { return std::cos(degrees * std::numbers::pi / 180); }

using Edges = std::vector<std::array<int, 2>>;  // lower end first, in order

Edges sharp_edges(const TriangleMesh& mesh, double degrees) {
  const auto neighbors = triangle_neighbors(mesh.triangles);
  std::vector<Eigen::Vector3d> normals;
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto& p = mesh.vertices;
    normals.push_back((p[b] - p[a]).cross(p[c] - p[a]).stableNormalized());
  }
  const double least = cosine(degrees);
  Edges edges;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (int e = 0; e < 3; ++e) {
      const int v = mesh.triangles[t][e], w = mesh.triangles[t][(e + 1) % 3];
      if (v < w && normals[t].dot(normals[neighbors[t][e]]) < least) edges.push_back({v, w});
    }
  }
  std::sort(edges.begin(), edges.end());
  return edges;
}

using Rings = std::vector<std::vector<int>>;  // of each vertex: the other ends of its edges

Rings rings_of(const Edges& edges, std::size_t vertices) {
  Rings rings(vertices);
  for (const auto& [v, w] : edges) {
    rings[v].push_back(w);
    rings[w].push_back(v);
  }
  return rings;
}

bool turns(const TriangleMesh& mesh, int before, int v, int after) {
  const Eigen::Vector3d in = (mesh.vertices[v] - mesh.vertices[before]).stableNormalized();
  const Eigen::Vector3d out = (mesh.vertices[after] - mesh.vertices[v]).stableNormalized();
  return in.dot(out) < cosine(kCornerDegrees);
}

void measure(FeatureChain& chain, const std::vector<Eigen::Vector3d>& positions) {
  chain.lengths = {0};
  for (std::size_t k = 1; k < chain.vertices.size(); ++k) {
    chain.lengths.push_back(chain.lengths.back() +
                            (positions[chain.vertices[k]] - positions[chain.vertices[k - 1]]).norm());
  }
}

/// The path from v over w to the next corner, or back to v.
FeatureChain traced(const Rings& rings, const std::vector<char>& corners, int v, int w) {
  FeatureChain chain{{v, w}, {}, false};
  while (w != chain.vertices.front() && corners[w] == 0) {
    const int next = rings[w][rings[w][0] == v ? 1 : 0];
    v = std::exchange(w, next);
    chain.vertices.push_back(w);
  }
  chain.loop = corners[w] == 0;
  return chain;
}

Features chains_of(const TriangleMesh& mesh, const Edges& edges) {
  const auto rings = rings_of(edges, mesh.vertices.size());
  Features features{{}, std::vector<char>(mesh.vertices.size(), 0)};
  for (std::size_t v = 0; v < rings.size(); ++v) {
    const auto& ring = rings[v];
    if (ring.empty()) continue;
    features.corners[v] = ring.size() != 2 || turns(mesh, ring[0], static_cast<int>(v), ring[1]) ? 1 : 0;
  }
  std::map<std::pair<int, int>, bool> met;
  const auto add_from = [&](int v) {
    for (const int w : rings[v]) {
      if (met[std::minmax(v, w)]) continue;
      auto chain = traced(rings, features.corners, v, w);
      for (std::size_t k = 1; k < chain.vertices.size(); ++k) {
        met[std::minmax(chain.vertices[k - 1], chain.vertices[k])] = true;
      }
      measure(chain, mesh.vertices);
      features.chains.push_back(std::move(chain));
    }
  };
  for (std::size_t v = 0; v < rings.size(); ++v) {
    if (features.corners[v] != 0) add_from(static_cast<int>(v));
  }
  for (std::size_t v = 0; v < rings.size(); ++v) add_from(static_cast<int>(v));
  return features;
}

/// Too short to be drawn on purpose: all by itself, or with a loose end.
bool is_noise(const FeatureChain& chain, const Rings& rings, double shortest) {
  const bool closed = chain.vertices.front() == chain.vertices.back();
  const bool loose = rings[chain.vertices.front()].size() == 1 || rings[chain.vertices.back()].size() == 1;
  return (closed || loose) && chain.lengths.back() < shortest;
}

}  // namespace

std::size_t Features::corner_count() const {
  return static_cast<std::size_t>(std::count(corners.begin(), corners.end(), 1));
}

Features find_features(const TriangleMesh& mesh, double degrees, double shortest) {
  auto edges = sharp_edges(mesh, degrees);
  while (true) {
    auto features = chains_of(mesh, edges);
    const auto rings = rings_of(edges, mesh.vertices.size());
    Edges kept;
    for (const auto& chain : features.chains) {
      if (is_noise(chain, rings, shortest)) continue;
      for (std::size_t k = 1; k < chain.vertices.size(); ++k) {
        const auto [v, w] = std::minmax(chain.vertices[k - 1], chain.vertices[k]);
        kept.push_back({v, w});
      }
    }
    if (kept.size() == edges.size()) return features;
    std::sort(kept.begin(), kept.end());
    edges = std::move(kept);
  }
}

FeatureCurves::FeatureCurves(const TriangleMesh& mesh, const std::vector<FeatureChain>& chains)
    : mesh_(mesh), chains_(chains) {
  std::map<std::pair<int, int>, std::array<int, 2>> side;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (int e = 0; e < 3; ++e) {
      side[{mesh.triangles[t][e], mesh.triangles[t][(e + 1) % 3]}] = {static_cast<int>(t), e};
    }
  }
  for (const auto& chain : chains_) {
    sides_.emplace_back();
    for (std::size_t k = 1; k < chain.vertices.size(); ++k) {
      sides_.back().push_back(side.at({chain.vertices[k - 1], chain.vertices[k]}));
    }
  }
}

FeatureCurves::Segment FeatureCurves::segment(const CurvePoint& place) const {
  const auto& lengths = chains_[place.chain].lengths;
  const auto after = std::upper_bound(lengths.begin() + 1, lengths.end() - 1, place.along);
  const auto index = static_cast<std::size_t>(after - lengths.begin() - 1);
  const double length = lengths[index + 1] - lengths[index];
  return {index, length > 0 ? std::clamp((place.along - lengths[index]) / length, 0.0, 1.0) : 0.0};
}

SurfacePoint FeatureCurves::point(const CurvePoint& place) const {
  const auto [index, share] = segment(place);
  const auto& [triangle, edge] = sides_[place.chain][index];
  SurfacePoint point{triangle, Eigen::Vector3d::Zero()};
  point.weights[edge] = 1 - share;
  point.weights[(edge + 1) % 3] = share;
  return point;
}

Eigen::Vector3d FeatureCurves::tangent(const CurvePoint& place) const {
  const auto& vertices = chains_[place.chain].vertices;
  const std::size_t k = segment(place).index;
  return (mesh_.vertices[vertices[k + 1]] - mesh_.vertices[vertices[k]]).stableNormalized();
}

CurvePoint FeatureCurves::moved(const CurvePoint& place, double by) const {
  const double length = whole(place.chain);
  double along = place.along + by;
  if (chains_[place.chain].loop) {
    along -= length * std::floor(along / length);
  }
  return {place.chain, std::clamp(along, 0.0, length), -1};
}

CurvePoint FeatureCurves::closest(int chain, const Eigen::Vector3d& x) const {
  const auto& [vertices, lengths, loop] = chains_[chain];
  CurvePoint best{chain, 0, -1};
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k + 1 < vertices.size(); ++k) {
    const Eigen::Vector3d& from = mesh_.vertices[vertices[k]];
    const Eigen::Vector3d edge = mesh_.vertices[vertices[k + 1]] - from;
    const double squared = edge.squaredNorm();
    const double share = squared > 0 ? std::clamp((x - from).dot(edge) / squared, 0.0, 1.0) : 0.0;
    const double distance = (from + share * edge - x).squaredNorm();
    if (distance < least) {
      least = distance;
      best.along = lengths[k] + share * (lengths[k + 1] - lengths[k]);
    }
  }
  return best;
}

double FeatureCurves::way(const CurvePoint& from, const CurvePoint& to) const {
  const double length = whole(from.chain);
  if (to.chain == CurvePoint::kCorner) {
    const auto& vertices = chains_[from.chain].vertices;
    const bool both = vertices.front() == vertices.back();
    const bool at_start = both ? from.along < length / 2 : to.corner == vertices.front();
    return (at_start ? 0.0 : length) - from.along;
  }
  const double way = to.along - from.along;
  return chains_[from.chain].loop ? way - length * std::round(way / length) : way;
}

FeatureLinks::FeatureLinks(const Features& features, std::size_t vertices) : links_(vertices), corners_(vertices, 0) {
  std::copy(features.corners.begin(), features.corners.end(), corners_.begin());
  for (std::size_t c = 0; c < features.chains.size(); ++c) {
    const auto& chain = features.chains[c].vertices;
    for (std::size_t k = 1; k < chain.size(); ++k) {
      links_[chain[k - 1]].push_back({chain[k], static_cast<int>(c)});
      links_[chain[k]].push_back({chain[k - 1], static_cast<int>(c)});
    }
  }
}

int FeatureLinks::chain(int v, int w) const {
  const auto& links = links_[v];
  const auto found = std::find_if(links.begin(), links.end(), [&](const Link& link) { return link.vertex == w; });
  return found == links.end() ? CurvePoint::kFree : found->chain;
}

int FeatureLinks::beyond(int v, int other) const { return links_[v][links_[v][0].vertex == other ? 1 : 0].vertex; }

bool FeatureLinks::may_collapse(int removed, int kept) const {
  if (is_corner(removed)) return false;
  if (is_free(removed)) return true;
  return chain(removed, kept) != CurvePoint::kFree && chain(beyond(removed, kept), kept) == CurvePoint::kFree;
}

void FeatureLinks::relink(int v, int from, int to) {
  for (auto& link : links_[v]) {
    if (link.vertex == from) link.vertex = to;
  }
}

void FeatureLinks::collapse(int removed, int kept) {
  if (is_free(removed)) return;
  const int other = beyond(removed, kept);
  relink(kept, removed, other);
  relink(other, removed, kept);
  links_[removed].clear();
}

void FeatureLinks::split(int v, int w, int middle) {
  const int on = chain(v, w);
  links_.emplace_back();
  corners_.push_back(0);
  if (on == CurvePoint::kFree) return;
  relink(v, w, middle);
  relink(w, v, middle);
  links_[middle] = {{v, on}, {w, on}};
}

Features FeatureLinks::features(const std::vector<int>& renumbered,
                                const std::vector<Eigen::Vector3d>& positions) const {
  Features result{{}, std::vector<char>(positions.size(), 0)};
  std::map<int, int> first;  // of each chain: a corner at its end, or else its lowest vertex
  for (int v = 0; v < static_cast<int>(links_.size()); ++v) {
    if (corners_[v] != 0 && renumbered[v] >= 0) result.corners[renumbered[v]] = 1;
    for (const auto& link : links_[v]) {
      const auto [entry, fresh] = first.try_emplace(link.chain, v);
      if (!fresh && corners_[entry->second] == 0 && corners_[v] != 0) entry->second = v;
    }
  }
  for (const auto& [id, start] : first) {
    FeatureChain chain{{start}, {}, corners_[start] == 0};
    int before = start;
    int v = std::find_if(links_[start].begin(), links_[start].end(), [id = id](const Link& link) {
              return link.chain == id;
            })->vertex;
    while (true) {
      chain.vertices.push_back(v);
      if (v == start || corners_[v] != 0) break;
      before = std::exchange(v, beyond(v, before));
    }
    for (int& vertex : chain.vertices) vertex = renumbered[vertex];
    measure(chain, positions);
    result.chains.push_back(std::move(chain));
  }
  return result;
}

}  // namespace greenloop::offline
