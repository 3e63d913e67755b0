#include "offline/surface/triangle_intersection.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>

#include "offline/surface/box_tree.hpp"
#include "offline/surface/coincident_vertices.hpp"
#include "offline/surface/orientation.hpp"

namespace greenloop::offline {
namespace {

using Triangle2 = std::array<Eigen::Vector2d, 3>;

/// The coordinate axis to drop so that the triangle's projection keeps an area.
int projection_axis(const Triangle& t) {
  const Eigen::Vector3d normal = (t[1] - t[0]).cross(t[2] - t[0]);
  int axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  return axis;
}

Eigen::Vector2d project(const Eigen::Vector3d& p, int axis) { return {p[(axis + 1) % 3], p[(axis + 2) % 3]}; }

bool contains(const Triangle2& t, const Eigen::Vector2d& p) {
  const int a = orientation(t[0], t[1], p);
  const int b = orientation(t[1], t[2], p);
  const int c = orientation(t[2], t[0], p);
  return (a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0);
}

/// For a point on the line through a and b: is it between them?
bool between(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& p) {
  return (a.cwiseMin(b).array() <= p.array()).all() && (p.array() <= a.cwiseMax(b).array()).all();
}

bool segments_touch(const Eigen::Vector2d& p, const Eigen::Vector2d& q, const Eigen::Vector2d& a,
                    const Eigen::Vector2d& b) {
  const int pa = orientation(p, q, a);
  const int pb = orientation(p, q, b);
  const int ap = orientation(a, b, p);
  const int aq = orientation(a, b, q);
  if (pa * pb < 0 && ap * aq < 0) {
    return true;
  }
  return (pa == 0 && between(p, q, a)) || (pb == 0 && between(p, q, b)) || (ap == 0 && between(a, b, p)) ||
         (aq == 0 && between(a, b, q));
}

bool coplanar_segment_touches(const Eigen::Vector3d& p3, const Eigen::Vector3d& q3, const Triangle& t3) {
  const int axis = projection_axis(t3);
  const auto p = project(p3, axis);
  const auto q = project(q3, axis);
  const Triangle2 t{project(t3[0], axis), project(t3[1], axis), project(t3[2], axis)};
  return contains(t, p) || segments_touch(p, q, t[0], t[1]) || segments_touch(p, q, t[1], t[2]) ||
         segments_touch(p, q, t[2], t[0]);
}

bool segment_touches(const Eigen::Vector3d& p, const Eigen::Vector3d& q, const Triangle& t) {
  const int side_p = orientation(t[0], t[1], t[2], p);
  const int side_q = orientation(t[0], t[1], t[2], q);
  if (side_p * side_q > 0) {
    return false;
  }
  if (side_p == 0 && side_q == 0) {
    return coplanar_segment_touches(p, q, t);
  }
  const int a = orientation(p, q, t[0], t[1]);
  const int b = orientation(p, q, t[1], t[2]);
  const int c = orientation(p, q, t[2], t[0]);
  return (a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0);
}

bool on_one_side(const Triangle& plane, const Triangle& t) {
  const int side = orientation(plane[0], plane[1], plane[2], t[0]);
  return side != 0 && orientation(plane[0], plane[1], plane[2], t[1]) == side &&
         orientation(plane[0], plane[1], plane[2], t[2]) == side;
}

/// Triangles with the edge s[0], s[1] = t[0], t[1]: they overlap if they are folded flat onto each other.
bool edge_neighbours_overlap(const Triangle& s, const Triangle& t) {
  if (orientation(s[0], s[1], s[2], t[2]) != 0) {
    return false;
  }
  const int axis = projection_axis(s);
  const auto a = project(s[0], axis);
  const auto b = project(s[1], axis);
  return orientation(a, b, project(s[2], axis)) == orientation(a, b, project(t[2], axis));
}

/// The two faces with their common vertices moved to the front, in the same order.
struct Pair {
  std::array<int, 3> s;
  std::array<int, 3> t;
  int common = 0;
};

Pair common_first(std::array<int, 3> s, std::array<int, 3> t) {
  int common = 0;
  for (int i = 0; i < 3; ++i) {
    auto* const match = std::find(t.begin() + common, t.end(), s[i]);
    if (match != t.end()) {
      std::swap(s[i], s[common]);
      std::iter_swap(match, t.begin() + common);
      ++common;
    }
  }
  return {s, t, common};
}

/// Part of the sizes at hand by which rounding cannot move a projection.
constexpr double margin = 1e-12;

/// Certainly no common point: all of t lies beyond s along this axis, which is orthogonal to s or to one of its sides.
bool beyond(const Triangle& t, const Eigen::Vector3d& from, const Eigen::Vector3d& axis) {
  const double size = from.norm() + t[0].norm() + t[1].norm() + t[2].norm();
  const double reach = margin * axis.norm() * size;
  return axis.dot(t[0] - from) > reach && axis.dot(t[1] - from) > reach && axis.dot(t[2] - from) > reach;
}

/// Certainly no common point: a plane through s, or one across that through a side of s, parts them. Spares faces in
/// one plane the exact tests.
bool clearly_apart(const Triangle& s, const Triangle& t) {
  const Eigen::Vector3d normal = (s[1] - s[0]).cross(s[2] - s[0]);
  if (beyond(t, s[0], normal) || beyond(t, s[0], -normal)) {
    return true;
  }
  for (std::size_t i = 0; i < 3; ++i) {
    if (beyond(t, s[i], (s[(i + 1) % 3] - s[i]).cross(normal))) {
      return true;
    }
  }
  return false;
}

/// Certainly no common point but s[0] = t[0]: the other corners lie on different sides of a plane through it.
bool part_at_vertex(const Triangle& s, const Triangle& t) {
  const std::array<Eigen::Vector3d, 4> d{s[1] - s[0], s[2] - s[0], t[1] - s[0], t[2] - s[0]};
  const Eigen::Vector3d axis = (d[0] + d[1]).normalized() - (d[2] + d[3]).normalized();
  const auto side = [&](std::size_t i) {
    const double along = axis.dot(d[i]);
    return std::abs(along) > margin * (d[i].norm() + s[0].norm()) ? (along > 0 ? 1 : -1) : 0;
  };
  return side(0) == 1 && side(1) == 1 && side(2) == -1 && side(3) == -1;
}

bool faces_intersect(const std::vector<Eigen::Vector3d>& x, const Pair& pair) {
  const Triangle s{x[pair.s[0]], x[pair.s[1]], x[pair.s[2]]};
  const Triangle t{x[pair.t[0]], x[pair.t[1]], x[pair.t[2]]};
  switch (pair.common) {
    case 0:
      return !clearly_apart(s, t) && !clearly_apart(t, s) && triangles_touch(s, t);
    case 1:
      return !part_at_vertex(s, t) && (segment_touches(s[1], s[2], t) || segment_touches(t[1], t[2], s));
    case 2:
      return edge_neighbours_overlap(s, t);
    default:
      return true;
  }
}

}  // namespace

bool triangles_touch(const Triangle& s, const Triangle& t) {
  if (on_one_side(s, t) || on_one_side(t, s)) {
    return false;
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    if (segment_touches(s[i], s[j], t) || segment_touches(t[i], t[j], s)) {
      return true;
    }
  }
  return false;
}

std::vector<std::array<int, 2>> self_intersections(const TriangleMesh& mesh, const std::vector<bool>& skip) {
  const auto representative = first_coincident_vertex(mesh.vertices);
  std::vector<Eigen::AlignedBox3d> boxes(mesh.triangles.size());
  for (std::size_t f = 0; f < boxes.size(); ++f) {
    for (const int vertex : mesh.triangles[f]) {
      boxes[f].extend(mesh.vertices[vertex]);
    }
  }
  const auto welded = [&](int f) {
    const auto& [a, b, c] = mesh.triangles[f];
    return std::array{representative[a], representative[b], representative[c]};
  };
  std::vector<std::array<int, 2>> pairs;
  std::size_t looks = 0;
  for_each_overlap(boxes, [&](int f, int g) {
    if (++looks > most_looks) {
      throw std::runtime_error(
          "more than " + std::to_string(most_looks) +
          " pairs of faces lie close to each other: the faces are too long and thin to be checked; "
          "remesh them to triangles of similar sides");
    }
    if (!skip[f] && !skip[g] && faces_intersect(mesh.vertices, common_first(welded(f), welded(g)))) {
      pairs.push_back({std::min(f, g), std::max(f, g)});
    }
    return pairs.size() < most_pairs;
  });
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace greenloop::offline
