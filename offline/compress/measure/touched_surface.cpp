#include "offline/compress/measure/touched_surface.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "formats/layout.hpp"
#include "offline/compress/measure/point_choice.hpp"

namespace greenloop::offline {
namespace {

using Corners = std::array<Eigen::Vector3d, 3>;

Corners corners_of(const std::vector<Eigen::Vector3d>& vertices, const std::array<int, 3>& triangle) {
  const auto at = [&](int k) { return vertices[static_cast<std::size_t>(triangle[static_cast<std::size_t>(k)])]; };
  return {at(0), at(1), at(2)};
}

// by area, per vertex; not normalised
std::vector<Eigen::Vector3d> outward_normals(const std::vector<Eigen::Vector3d>& vertices,
                                             const std::vector<std::array<int, 3>>& triangles) {
  std::vector<Eigen::Vector3d> normals(vertices.size(), Eigen::Vector3d::Zero());
  double volume = 0;
  for (const auto& triangle : triangles) {
    const auto [a, b, c] = corners_of(vertices, triangle);
    const Eigen::Vector3d normal = (b - a).cross(c - a);
    volume += (a - vertices[0]).dot(normal);
    for (const int vertex : triangle) normals[static_cast<std::size_t>(vertex)] += normal;
  }
  if (volume < 0) {
    for (auto& normal : normals) normal = -normal;
  }
  return normals;
}

// where a ray meets a triangle, in lengths of `along` (Moeller and Trumbore 1997); none if it misses
std::optional<double> meets(const Eigen::Vector3d& from, const Eigen::Vector3d& along, const Corners& corners) {
  const Eigen::Vector3d ab = corners[1] - corners[0], ac = corners[2] - corners[0], across = along.cross(ac);
  const double determinant = ab.dot(across);
  if (determinant == 0) return {};
  const Eigen::Vector3d offset = from - corners[0], turned = offset.cross(ab);
  const double u = offset.dot(across) / determinant, v = along.dot(turned) / determinant;
  if (!(u >= 0 && v >= 0 && u + v <= 1)) return {};
  return ac.dot(turned) / determinant;
}

}  // namespace

TouchedSurface::TouchedSurface(const SemiRegularMesh& mesh, const std::vector<std::uint32_t>& flags,
                               const std::vector<double>& area, const SurfaceWavelet& wavelet)
    : vertex_(mesh.positions), triangle_(triangles_of_level(mesh, mesh.finest_level())) {
  const auto normals = outward_normals(vertex_, triangle_);
  for (std::size_t row = 0; row < wavelet.rows(); ++row) {
    const std::size_t node = wavelet.nodes()[row];
    if ((flags[node] & layout::node_touchable) == 0) continue;
    row_.push_back(row);
    node_.push_back(node);
    position_.push_back(mesh.positions[node]);
    normal_.push_back(normals[node].norm() > 0 ? normals[node].normalized() : Eigen::Vector3d(0, 0, 1));
    area_.push_back(area[node]);
  }
}

std::vector<std::size_t> TouchedSurface::nearest_facing(const Eigen::Vector3d& place, const Eigen::Vector3d& direction,
                                                        std::size_t count) const {
  if (direction.isZero(0)) return nearest_points(position_, place, count);
  std::vector<std::size_t> facing;
  std::vector<Eigen::Vector3d> positions;
  for (std::size_t i = 0; i < size(); ++i) {
    if (!(normal_[i].dot(direction) > 0)) continue;
    facing.push_back(i);
    positions.push_back(position_[i]);
  }
  auto chosen = nearest_points(positions, place, count);
  for (std::size_t& i : chosen) i = facing[i];
  return chosen;
}

std::optional<double> TouchedSurface::thickness(std::size_t point) const {
  std::optional<double> least;
  const auto node = static_cast<int>(node_[point]);
  for (const auto& triangle : triangle_) {
    if (std::find(triangle.begin(), triangle.end(), node) != triangle.end()) continue;
    const auto distance = meets(position_[point], -normal_[point], corners_of(vertex_, triangle));
    if (distance && *distance > 0 && (!least || *distance < *least)) least = distance;
  }
  return least;
}

}  // namespace greenloop::offline
