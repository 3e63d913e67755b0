#include "offline/wrap/crossings.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "offline/surface/orientation.hpp"

namespace greenloop::offline {
namespace {

using Corners = std::array<Eigen::Vector3d, 3>;

/// A face seen along an axis.
class Projection {
 public:
  Projection(const Corners& corners, int axis) : u_((axis + 1) % 3), v_((axis + 2) % 3) {
    for (int i = 0; i < 3; ++i) flat_[i] = {corners[i][u_], corners[i][v_]};
    turn_ = orientation(flat_[0], flat_[1], flat_[2]);
    const Eigen::Vector3d normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    slope_ = {-normal[u_] / normal[axis], -normal[v_] / normal[axis]};
    height_ = corners[0][axis];
  }

  /// Calls visit(u, v, height) for the whole coordinates that the face covers.
  template <class Visit>
  void for_each_covered(const Visit& visit) const {
    if (turn_ == 0) return;
    const auto [low, high] = std::minmax({flat_[0].y(), flat_[1].y(), flat_[2].y()});
    for (int v = static_cast<int>(std::ceil(low)); v <= static_cast<int>(std::floor(high)); ++v) {
      const auto [first, last] = range_at(v);
      for (int u = first; u <= last; ++u) {
        if (covers({u, v})) visit(u, v, height_ + slope_.dot(Eigen::Vector2d(u, v) - flat_[0]));
      }
    }
  }

  [[nodiscard]] int u() const { return u_; }
  [[nodiscard]] int v() const { return v_; }

 private:
  /// The whole coordinates u that may be covered in row v.
  [[nodiscard]] std::array<int, 2> range_at(int v) const {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector2d &a = flat_[i], &b = flat_[(i + 1) % 3];
      const auto [below, above] = std::minmax({a.y(), b.y()});
      if (below > v || above < v) continue;
      const double t = above > below ? std::clamp((v - a.y()) / (b.y() - a.y()), 0.0, 1.0) : 0;
      for (const double s : above > below ? std::array{t, t} : std::array{0.0, 1.0}) {
        low = std::min(low, a.x() + s * (b.x() - a.x()));
        high = std::max(high, a.x() + s * (b.x() - a.x()));
      }
    }
    constexpr double rounding = 1e-6;  // the exact test follows
    return {static_cast<int>(std::ceil(low - rounding)), static_cast<int>(std::floor(high + rounding))};
  }

  [[nodiscard]] bool covers(const Eigen::Vector2d& p) const {
    for (int i = 0; i < 3; ++i) {
      if (orientation(flat_[i], flat_[(i + 1) % 3], p) == -turn_) return false;
    }
    return true;
  }

  int u_, v_;
  std::array<Eigen::Vector2d, 3> flat_;
  int turn_;
  Eigen::Vector2d slope_;
  double height_;
};

void mark_shared_edges(std::vector<Crossing>& crossings, const Lattice& lattice) {
  std::vector<std::uint8_t> once(lattice.count(), 0), twice(lattice.count(), 0);
  for (const auto& [point, face, at, axis, alone] : crossings) {
    const unsigned bit = 1U << axis;
    twice[point] = static_cast<std::uint8_t>(twice[point] | (once[point] & bit));
    once[point] = static_cast<std::uint8_t>(once[point] | bit);
  }
  for (auto& crossing : crossings) crossing.alone = (twice[crossing.point] >> crossing.axis & 1U) == 0;
}

}  // namespace

std::vector<Crossing> find_crossings(const TriangleMesh& mesh, const Lattice& lattice) {
  std::vector<Crossing> crossings;
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    const auto& [a, b, c] = mesh.triangles[f];
    const Corners corners{mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]};
    for (int axis = 0; axis < 3; ++axis) {
      const auto [low, high] = std::minmax({corners[0][axis], corners[1][axis], corners[2][axis]});
      const Projection seen(corners, axis);
      seen.for_each_covered([&, low = low, high = high](int u, int v, double height) {
        const double place = std::clamp(height, low, high);
        std::array<int, 3> point{};
        point[axis] = static_cast<int>(std::floor(place));
        point[seen.u()] = u;
        point[seen.v()] = v;
        if (crossings.size() == most_crossings) {
          throw std::runtime_error("wrap: the faces overlap so often that they cross the lattice more than " +
                                   std::to_string(most_crossings) + " times; choose a longer wrap");
        }
        crossings.push_back({static_cast<std::uint32_t>(lattice.index(point)), static_cast<int>(f),
                             static_cast<float>(place - point[axis]), static_cast<std::uint8_t>(axis), true});
      });
    }
  }
  mark_shared_edges(crossings, lattice);
  return crossings;
}

Eigen::Vector3d Crossing::place(const Lattice& lattice) const {
  const auto start = lattice.point(point);
  Eigen::Vector3d result(start[0], start[1], start[2]);
  result[axis] += at;
  return result;
}

std::vector<double> area_of_crossing(const TriangleMesh& mesh) {
  std::vector<double> area;
  area.reserve(mesh.triangles.size());
  for (const auto& [a, b, c] : mesh.triangles) {
    const Eigen::Vector3d normal =
        (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]).normalized();
    area.push_back(1 / normal.lpNorm<1>());
  }
  return area;
}

std::vector<std::uint8_t> crossed_axes(const std::vector<Crossing>& crossings, const Lattice& lattice) {
  std::vector<std::uint8_t> axes(lattice.count(), 0);
  for (const auto& crossing : crossings) {
    axes[crossing.point] = static_cast<std::uint8_t>(axes[crossing.point] | (1U << crossing.axis));
  }
  return axes;
}

}  // namespace greenloop::offline
