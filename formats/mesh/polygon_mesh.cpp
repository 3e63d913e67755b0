#include "formats/mesh/polygon_mesh.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

namespace greenloop {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Twice a triangle's area over its longest side squared: one below this is taken for flat.
constexpr double flat = 1e-9;

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

double turn(const Vector2d& a, const Vector2d& b, const Vector2d& c) { return cross(b - a, c - a); }

/// Twice the area over the longest side squared; negative for a triangle that runs clockwise.
double quality(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  const double longest = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
  return longest > 0 ? turn(a, b, c) / longest : 0;
}

/// The polygon seen along the largest part of its area's normal, counter-clockwise; nothing if it has no area.
std::vector<Vector2d> flattened(const std::vector<Vector3d>& vertices, std::span<const int> polygon) {
  const Vector3d& origin = vertices[static_cast<std::size_t>(polygon[0])];
  std::vector<Vector3d> corners;
  corners.reserve(polygon.size());
  double longest = 0;
  for (const int vertex : polygon) {
    corners.emplace_back(vertices[static_cast<std::size_t>(vertex)] - origin);
    longest = std::max(longest, corners.back().cwiseAbs().maxCoeff());
  }
  Vector3d normal = Vector3d::Zero();
  for (std::size_t i = 0; i < corners.size() && longest > 0; ++i) {
    normal += (corners[i] / longest).cross(corners[(i + 1) % corners.size()] / longest);
  }
  if (!(normal.norm() > flat)) {
    return {};
  }
  Eigen::Index axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  const bool turned = normal[axis] < 0;
  std::vector<Vector2d> result;
  result.reserve(corners.size());
  for (const Vector3d& corner : corners) {
    const Vector2d seen(corner[(axis + 1) % 3] / longest, corner[(axis + 2) % 3] / longest);
    result.emplace_back(turned ? Vector2d(seen.y(), seen.x()) : seen);
  }
  return result;
}

/// All corners are seen from the first one, in their order and within half a turn.
bool is_fan(const std::vector<Vector2d>& p) {
  for (std::size_t i = 2; i < p.size(); ++i) {
    if (!(quality(p[0], p[i - 1], p[i]) > flat) || !(turn(p[0], p[1], p[i]) > 0)) {
      return false;
    }
  }
  return true;
}

/// True where a and b lie on different sides of the line from p to q, neither of them near it.
bool parts(const Vector2d& p, const Vector2d& q, const Vector2d& a, const Vector2d& b) {
  constexpr double near = 1e-12;  // of the polygon's size squared
  const double left = turn(p, q, a), right = turn(p, q, b);
  return (left > near && right < -near) || (left < -near && right > near);
}

bool crosses_itself(const std::vector<Vector2d>& p) {
  const std::size_t n = p.size();
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 2; j < n; ++j) {
      const Vector2d &a = p[i], &b = p[(i + 1) % n], &c = p[j], &d = p[(j + 1) % n];
      if (parts(a, b, c, d) && parts(c, d, a, b)) {
        return true;
      }
    }
  }
  return false;
}

/// Clips one ear after the other, each the best-shaped there is.
class EarClipper {
 public:
  explicit EarClipper(const std::vector<Vector2d>& points) : p_(points), left_(points.size()), worth_(points.size()) {
    std::iota(left_.begin(), left_.end(), std::size_t{0});
    for (std::size_t at = 0; at < left_.size(); ++at) {
      measure(at);
    }
  }

  /// Triangles of corner numbers; false if no ear is left before the end.
  bool clip(std::vector<std::array<std::size_t, 3>>& ears) {
    while (left_.size() > 3) {
      const auto best = std::max_element(worth_.begin(), worth_.end());
      if (*best == no_ear) {
        return false;
      }
      const auto at = static_cast<std::size_t>(best - worth_.begin());
      ears.push_back({before(at), left_[at], after(at)});
      left_.erase(left_.begin() + static_cast<std::ptrdiff_t>(at));
      worth_.erase(best);
      measure(at % left_.size());
      measure((at + left_.size() - 1) % left_.size());
    }
    ears.push_back({left_[0], left_[1], left_[2]});
    return true;
  }

 private:
  static constexpr double no_ear = -1;

  [[nodiscard]] std::size_t before(std::size_t at) const { return left_[(at + left_.size() - 1) % left_.size()]; }
  [[nodiscard]] std::size_t after(std::size_t at) const { return left_[(at + 1) % left_.size()]; }

  /// A flat ear is the last choice.
  void measure(std::size_t at) {
    const Vector2d &a = p_[before(at)], &b = p_[left_[at]], &c = p_[after(at)];
    const double shape = quality(a, b, c);
    worth_[at] = shape > flat && is_empty(a, b, c) ? shape : std::abs(shape) <= flat ? 0 : no_ear;
  }

  [[nodiscard]] bool is_empty(const Vector2d& a, const Vector2d& b, const Vector2d& c) const {
    return std::none_of(left_.begin(), left_.end(), [&](std::size_t i) {
      const Vector2d& q = p_[i];
      return q != a && q != b && q != c && turn(a, b, q) >= 0 && turn(b, c, q) >= 0 && turn(c, a, q) >= 0;
    });
  }

  const std::vector<Vector2d>& p_;
  std::vector<std::size_t> left_;
  std::vector<double> worth_;  ///< of the ear at each corner that is left
};

bool on_one_line(const std::vector<Vector3d>& vertices, std::span<const int> polygon) {
  const auto corner = [&](std::size_t i) { return vertices[static_cast<std::size_t>(polygon[i])]; };
  Vector3d along = Vector3d::Zero();
  for (std::size_t i = 1; i < polygon.size(); ++i) {
    const Vector3d d = corner(i) - corner(0);
    along = d.stableNorm() > along.stableNorm() ? d : along;
  }
  const double length = along.stableNorm();
  const auto beside = [&](int vertex) {
    const Vector3d d = vertices[static_cast<std::size_t>(vertex)] - corner(0);
    return length > 0 && (d / length).cross(along / length).norm() > flat;
  };
  return std::none_of(polygon.begin(), polygon.end(), beside);
}

/// Corner numbers of the triangles, "" or what is wrong with the polygon.
const char* cut(const std::vector<Vector3d>& vertices, std::span<const int> polygon,
                std::vector<std::array<std::size_t, 3>>& triangles) {
  const auto points = polygon.size() > 3 ? flattened(vertices, polygon) : std::vector<Vector2d>{};
  if (polygon.size() == 3 || (points.empty() && on_one_line(vertices, polygon)) ||
      (!points.empty() && is_fan(points))) {
    for (std::size_t i = 2; i < polygon.size(); ++i) {
      triangles.push_back({0, i - 1, i});
    }
    return "";
  }
  if (polygon.size() > most_corners) {
    return "is not convex and has more corners than can be cut";
  }
  if (points.empty() || crosses_itself(points) || !EarClipper(points).clip(triangles)) {
    return "crosses itself";
  }
  return "";
}

void copy_without_repeats(std::span<const int> polygon, std::vector<int>& corners) {
  corners.assign(polygon.begin(), polygon.end());
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  while (corners.size() > 1 && corners.back() == corners.front()) {
    corners.pop_back();
  }
}

}  // namespace

void PolygonMesh::add(std::span<const int> polygon, std::size_t line) {
  corners.insert(corners.end(), polygon.begin(), polygon.end());
  ends.push_back(corners.size());
  lines.push_back(line);
}

TriangleMesh triangulate(const std::filesystem::path& file, PolygonMesh mesh, MeshNotes& notes) {
  TriangleMesh result;
  result.triangles.reserve(mesh.size());
  std::vector<std::array<std::size_t, 3>> triangles;
  std::vector<int> corners;
  std::size_t dropped = 0;
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    copy_without_repeats(mesh[i], corners);
    if (corners.size() < 3) {
      ++dropped;
      continue;
    }
    triangles.clear();
    if (const std::string fault = cut(mesh.vertices, corners, triangles); !fault.empty()) {
      std::string place = file.string();
      if (mesh.lines[i] > 0) {
        place.append(":").append(std::to_string(mesh.lines[i]));
      }
      throw MeshFileError(place + ": found face " + std::to_string(i) + " (counted from 0) of " +
                          std::to_string(corners.size()) + " corners that " + fault +
                          ", expected a simple polygon; cut it into triangles");
    }
    for (const auto& [a, b, c] : triangles) {
      result.triangles.push_back({corners[a], corners[b], corners[c]});
    }
  }
  if (dropped > 0) {
    notes.push_back(file.string() + ": " + std::to_string(dropped) + (dropped == 1 ? " face" : " faces") +
                    " of fewer than three different corners dropped");
  }
  result.vertices = std::move(mesh.vertices);
  return result;
}

}  // namespace greenloop
