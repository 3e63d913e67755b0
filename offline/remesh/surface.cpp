#include "offline/remesh/surface.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>

namespace greenloop::offline {
namespace {

struct DirectedEdge {
  int low, high;
  bool forward;
  int triangle, edge;
};

Eigen::Vector3d clamped(const Eigen::Vector3d& weights) {
  const Eigen::Vector3d positive = weights.cwiseMax(0.0);
  return positive / positive.sum();
}

/// Rates of change of the barycentric weights for a velocity in the plane of the triangle (a, b, c).
Eigen::Vector3d weight_rates(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                             const Eigen::Vector3d& velocity) {
  const Eigen::Vector3d u = b - a, v = c - a;
  const double uu = u.squaredNorm(), uv = u.dot(v), vv = v.squaredNorm();
  const double determinant = uu * vv - uv * uv;
  if (determinant <= 0) return Eigen::Vector3d::Zero();
  const double du = velocity.dot(u), dv = velocity.dot(v);
  const double rate_b = (vv * du - uv * dv) / determinant;
  const double rate_c = (uu * dv - uv * du) / determinant;
  return {-rate_b - rate_c, rate_b, rate_c};
}

}  // namespace

std::vector<std::array<int, 3>> triangle_neighbors(const std::vector<std::array<int, 3>>& triangles) {
  std::vector<DirectedEdge> edges;
  edges.reserve(3 * triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (int e = 0; e < 3; ++e) {
      const int from = triangles[t][e], to = triangles[t][(e + 1) % 3];
      edges.push_back({std::min(from, to), std::max(from, to), from < to, static_cast<int>(t), e});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const DirectedEdge& x, const DirectedEdge& y) {
    return std::pair(x.low, x.high) < std::pair(y.low, y.high);
  });
  std::vector<std::array<int, 3>> neighbors(triangles.size());
  for (std::size_t k = 0; k < edges.size(); k += 2) {
    const auto same = [&](std::size_t other) {
      return other < edges.size() && edges[other].low == edges[k].low && edges[other].high == edges[k].high;
    };
    if (!same(k + 1) || same(k + 2) || edges[k].forward == edges[k + 1].forward || edges[k].low == edges[k].high) {
      throw std::invalid_argument("surface: edge (" + std::to_string(edges[k].low) + ", " +
                                  std::to_string(edges[k].high) +
                                  ") is not shared by exactly two consistently oriented triangles; close the surface "
                                  "and make it manifold first");
    }
    neighbors[edges[k].triangle][edges[k].edge] = edges[k + 1].triangle;
    neighbors[edges[k + 1].triangle][edges[k + 1].edge] = edges[k].triangle;
  }
  return neighbors;
}

Surface::Surface(TriangleMesh mesh, const std::vector<std::array<int, 2>>& sharp)
    : mesh_(std::move(mesh)),
      neighbors_(triangle_neighbors(mesh_.triangles)),
      sharp_(mesh_.triangles.size(), {0, 0, 0}) {
  vertex_normals_.assign(mesh_.vertices.size(), Eigen::Vector3d::Zero());
  triangle_normals_.reserve(mesh_.triangles.size());
  for (const auto& corners : mesh_.triangles) {
    std::array<Eigen::Vector3d, 3> p;
    for (int c = 0; c < 3; ++c) p[c] = mesh_.vertices[corners[c]];
    triangle_normals_.push_back((p[1] - p[0]).cross(p[2] - p[0]).stableNormalized());
    for (int c = 0; c < 3; ++c) {
      const Eigen::Vector3d u = p[(c + 1) % 3] - p[c], v = p[(c + 2) % 3] - p[c];
      vertex_normals_[corners[c]] += std::atan2(u.cross(v).norm(), u.dot(v)) * triangle_normals_.back();
    }
  }
  for (auto& normal : vertex_normals_) normal.stableNormalize();
  set_sharp(sharp);
}

void Surface::set_sharp(const std::vector<std::array<int, 2>>& edges) {
  std::set<std::pair<int, int>> sharp;
  for (const auto& [v, w] : edges) {
    sharp.emplace(std::minmax(v, w));
    vertex_normals_[v].setZero();
    vertex_normals_[w].setZero();
  }
  if (sharp.empty()) return;
  for (std::size_t t = 0; t < sharp_.size(); ++t) {
    for (int e = 0; e < 3; ++e) {
      const int v = mesh_.triangles[t][e], w = mesh_.triangles[t][(e + 1) % 3];
      sharp_[t][e] = sharp.contains(std::minmax(v, w)) ? 1 : 0;
    }
  }
}

Eigen::Vector3d Surface::position(const SurfacePoint& point) const {
  const auto& [a, b, c] = mesh_.triangles[point.triangle];
  return point.weights[0] * mesh_.vertices[a] + point.weights[1] * mesh_.vertices[b] +
         point.weights[2] * mesh_.vertices[c];
}

Eigen::Vector3d Surface::normal(const SurfacePoint& point) const {
  const auto& [a, b, c] = mesh_.triangles[point.triangle];
  const Eigen::Vector3d mean = point.weights[0] * vertex_normals_[a] + point.weights[1] * vertex_normals_[b] +
                               point.weights[2] * vertex_normals_[c];
  const double length = mean.norm();
  return length > 1e-6 ? Eigen::Vector3d(mean / length) : triangle_normals_[point.triangle];
}

SurfacePoint Surface::walk(const SurfacePoint& start, const Eigen::Vector3d& displacement) const {
  constexpr int kMaxCrossings = 1000;
  SurfacePoint here = start;
  double remaining = displacement.norm();
  const Eigen::Vector3d& n = triangle_normals_[here.triangle];
  Eigen::Vector3d direction = (displacement - displacement.dot(n) * n).stableNormalized();
  int entered = -1;  // the corner opposite the edge we came through: its weight can only grow
  for (int crossing = 0; crossing < kMaxCrossings && remaining > 0; ++crossing) {
    const auto& corners = mesh_.triangles[here.triangle];
    const Eigen::Vector3d rates =
        weight_rates(mesh_.vertices[corners[0]], mesh_.vertices[corners[1]], mesh_.vertices[corners[2]], direction);
    double step = remaining;
    int leaving = -1;
    for (int c = 0; c < 3; ++c) {
      if (rates[c] >= 0 || c == entered) continue;
      const double reach = here.weights[c] / -rates[c];
      if (reach < step) {
        step = reach;
        leaving = c;
      }
    }
    here.weights = clamped(here.weights + step * rates);
    if (leaving < 0) break;
    remaining -= step;

    // unfold the neighbour across the edge opposite the corner whose weight ran out
    const int edge = (leaving + 1) % 3;
    if (sharp_[here.triangle][edge] != 0) break;
    const int from = corners[edge], to = corners[(edge + 1) % 3];
    const int next = neighbors_[here.triangle][edge];
    const auto& next_corners = mesh_.triangles[next];
    SurfacePoint beyond{next, Eigen::Vector3d::Zero()};
    for (int c = 0; c < 3; ++c) {
      if (next_corners[c] == from) {
        beyond.weights[c] = here.weights[edge];
      } else if (next_corners[c] == to) {
        beyond.weights[c] = here.weights[(edge + 1) % 3];
      } else {
        entered = c;
      }
    }
    const Eigen::Vector3d along = (mesh_.vertices[to] - mesh_.vertices[from]).stableNormalized();
    const Eigen::Vector3d inward = along.cross(triangle_normals_[next]).stableNormalized();
    const double forward = direction.dot(along);
    direction = (forward * along + std::sqrt(std::max(0.0, 1 - forward * forward)) * inward).stableNormalized();
    beyond.weights = clamped(beyond.weights);
    here = beyond;
  }
  return here;
}

}  // namespace greenloop::offline
