#include "offline/remesh/self_intersection.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "offline/remesh/triangle_tree.hpp"

namespace greenloop::offline {
namespace {

using Point = Eigen::Vector3d;
using Corners = std::array<Point, 3>;

/// Sign of the volume of (a, b, c, d); 0 where rounding could have turned it.
int orientation(const Point& a, const Point& b, const Point& c, const Point& d) {
  const Point u = a - d, v = b - d, w = c - d;
  const double m1 = v.x() * w.y(), m2 = w.x() * v.y(), m3 = w.x() * u.y();
  const double m4 = u.x() * w.y(), m5 = u.x() * v.y(), m6 = v.x() * u.y();
  const double determinant = u.z() * (m1 - m2) + v.z() * (m3 - m4) + w.z() * (m5 - m6);
  const double permanent = (std::abs(m1) + std::abs(m2)) * std::abs(u.z()) +
                           (std::abs(m3) + std::abs(m4)) * std::abs(v.z()) +
                           (std::abs(m5) + std::abs(m6)) * std::abs(w.z());
  constexpr double kBound = 7.8e-16;  // (7 + 56 eps) eps, eps = 2^-53
  if (std::abs(determinant) <= kBound * permanent) return 0;
  return determinant > 0 ? 1 : -1;
}

double cross(const Eigen::Vector2d& u, const Eigen::Vector2d& v) { return u.x() * v.y() - u.y() * v.x(); }

bool segments_meet(const Eigen::Vector2d& p, const Eigen::Vector2d& q, const Eigen::Vector2d& a,
                   const Eigen::Vector2d& b) {
  return cross(q - p, a - p) * cross(q - p, b - p) <= 0 && cross(b - a, p - a) * cross(b - a, q - a) <= 0;
}

/// A segment in the plane of a triangle, seen along the axis most normal to it.
bool meets_in_plane(const Point& p, const Point& q, const Corners& t) {
  int axis = 0;
  (t[1] - t[0]).cross(t[2] - t[0]).cwiseAbs().maxCoeff(&axis);
  const auto flat = [axis](const Point& x) { return Eigen::Vector2d(x[(axis + 1) % 3], x[(axis + 2) % 3]); };
  const std::array<Eigen::Vector2d, 3> f{flat(t[0]), flat(t[1]), flat(t[2])};
  const Eigen::Vector2d fp = flat(p), fq = flat(q);
  for (int e = 0; e < 3; ++e) {
    if (segments_meet(fp, fq, f[e], f[(e + 1) % 3])) return true;
  }
  const double s0 = cross(f[1] - f[0], fp - f[0]), s1 = cross(f[2] - f[1], fp - f[1]),
               s2 = cross(f[0] - f[2], fp - f[2]);
  return (s0 >= 0 && s1 >= 0 && s2 >= 0) || (s0 <= 0 && s1 <= 0 && s2 <= 0);
}

bool segment_meets(const Point& p, const Point& q, const Corners& t) {
  const int at_p = orientation(t[0], t[1], t[2], p), at_q = orientation(t[0], t[1], t[2], q);
  if (at_p * at_q > 0) return false;
  if (at_p == 0 && at_q == 0) return meets_in_plane(p, q, t);
  const int s0 = orientation(p, q, t[0], t[1]), s1 = orientation(p, q, t[1], t[2]), s2 = orientation(p, q, t[2], t[0]);
  return (s0 >= 0 && s1 >= 0 && s2 >= 0) || (s0 <= 0 && s1 <= 0 && s2 <= 0);
}

/// Two triangles over one edge lie on each other: coplanar, and both on the same side of it.
bool folded_flat(const Corners& s, const Corners& t) {
  const Point m = (s[1] - s[0]).cross(s[2] - s[0]).stableNormalized();
  const Point n = (t[1] - t[0]).cross(t[2] - t[0]).stableNormalized();
  return m.dot(n) < 0 && m.cross(n).norm() < 1e-9;
}

bool meet(const TriangleMesh& mesh, const std::array<int, 3>& s, const std::array<int, 3>& t) {
  const auto corners_of = [&](const std::array<int, 3>& v) {
    return Corners{mesh.vertices[v[0]], mesh.vertices[v[1]], mesh.vertices[v[2]]};
  };
  const auto holds = [](const std::array<int, 3>& corners, int v) {
    return std::find(corners.begin(), corners.end(), v) != corners.end();
  };
  const auto shared = std::count_if(s.begin(), s.end(), [&](int v) { return holds(t, v); });
  const Corners p = corners_of(s), q = corners_of(t);
  if (shared >= 2) return folded_flat(p, q);
  // edges that have no end in common with the other triangle
  for (int e = 0; e < 3; ++e) {
    const int f = (e + 1) % 3;
    if (!holds(t, s[e]) && !holds(t, s[f]) && segment_meets(p[e], p[f], q)) return true;
    if (!holds(s, t[e]) && !holds(s, t[f]) && segment_meets(q[e], q[f], p)) return true;
  }
  return false;
}

}  // namespace

std::vector<std::pair<int, int>> self_intersections(const TriangleMesh& mesh) {
  std::vector<std::pair<int, int>> found;
  for (const auto& [s, t] : TriangleTree(mesh).overlapping_boxes()) {
    if (meet(mesh, mesh.triangles[s], mesh.triangles[t])) found.emplace_back(s, t);
  }
  return found;
}

}  // namespace greenloop::offline
