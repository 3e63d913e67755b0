#include "offline/remesh/quality.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "offline/remesh/surface.hpp"
#include "offline/remesh/triangle_tree.hpp"
#include "offline/surface/area_and_volume.hpp"
#include "offline/surface/triangle_intersection.hpp"

namespace greenloop::offline {
namespace {

/// A greatest or smallest value, and where it is.
struct Extreme {
  double value;
  Eigen::Vector3d place;
};

Extreme sharpest(const TriangleMesh& mesh) {
  Extreme least{std::numbers::pi, Eigen::Vector3d::Zero()};
  for (const auto& corners : mesh.triangles) {
    for (int c = 0; c < 3; ++c) {
      const Eigen::Vector3d u = mesh.vertices[corners[(c + 1) % 3]] - mesh.vertices[corners[c]];
      const Eigen::Vector3d v = mesh.vertices[corners[(c + 2) % 3]] - mesh.vertices[corners[c]];
      const double angle = std::atan2(u.cross(v).norm(), u.dot(v));
      if (angle < least.value) least = {angle, mesh.vertices[corners[c]]};
    }
  }
  return {least.value * 180 / std::numbers::pi, least.place};
}

std::size_t flipped_triangles(const TriangleMesh& mesh, const Surface& input, const TriangleTree& input_tree,
                              Eigen::Vector3d& place) {
  std::vector<Eigen::Vector3d> normals;
  normals.reserve(mesh.vertices.size());
  for (const auto& v : mesh.vertices) normals.push_back(input.normal(input_tree.closest(v)));
  return static_cast<std::size_t>(std::count_if(mesh.triangles.begin(), mesh.triangles.end(), [&](const auto& t) {
    const auto& a = mesh.vertices[t[0]];
    const Eigen::Vector3d normal = (mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a);
    const bool flipped = !(normal.dot(normals[t[0]] + normals[t[1]] + normals[t[2]]) > 0);
    if (flipped) place = a;
    return flipped;
  }));
}

/// The greatest distance from samples of `from` to the surface of `to`.
Extreme one_sided_distance(const TriangleMesh& from, const TriangleTree& to, double spacing) {
  Extreme greatest{0, from.vertices.front()};
  const auto sample = [&](const Eigen::Vector3d& p) {
    const double distance = to.distance(p, greatest.value);
    if (distance > greatest.value) greatest = {distance, p};
  };
  for (const auto& vertex : from.vertices) sample(vertex);
  for (const auto& [ia, ib, ic] : from.triangles) {
    const auto &a = from.vertices[ia], &b = from.vertices[ib], &c = from.vertices[ic];
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    const int steps = std::max(2, static_cast<int>(std::ceil(longest / spacing)));
    for (int i = 0; i <= steps; ++i) {
      for (int j = 0; i + j <= steps; ++j) {
        sample(a + (b - a) * (static_cast<double>(i) / steps) + (c - a) * (static_cast<double>(j) / steps));
      }
    }
  }
  return greatest;
}

}  // namespace

double smallest_angle(const TriangleMesh& mesh) { return sharpest(mesh).value; }

RemeshQuality measure_quality(const TriangleMesh& input, const SemiRegularMesh& mesh) {
  const TriangleMesh finest{mesh.positions, triangles_of_level(mesh, mesh.finest_level())};
  const Surface surface(input);
  const TriangleTree input_tree(input), finest_tree(finest);
  Eigen::AlignedBox3d box;
  for (const auto& vertex : input.vertices) box.extend(vertex);
  const double diagonal = box.diagonal().norm();

  RemeshQuality quality;
  const auto fraction = [&](const Eigen::Vector3d& place) -> Eigen::Vector3d {
    return (place - box.min()).cwiseQuotient(box.sizes().cwiseMax(1e-300));
  };
  const auto angle = sharpest(finest);
  quality.smallest_angle_degrees = angle.value;
  quality.smallest_angle_at = fraction(angle.place);
  const auto of_mesh = one_sided_distance(finest, input_tree, diagonal / 400);
  const auto of_input = one_sided_distance(input, finest_tree, diagonal / 400);
  const auto& distance = of_input.value > of_mesh.value ? of_input : of_mesh;
  quality.farthest_of_mesh = of_mesh.value;
  quality.farthest_of_input = of_input.value;
  quality.volume_change = enclosed_volume(finest) / enclosed_volume(input) - 1;
  quality.hausdorff = distance.value;
  quality.hausdorff_at = fraction(distance.place);
  quality.hausdorff_relative = quality.hausdorff / diagonal;
  quality.triangles = finest.triangles.size();
  Eigen::Vector3d flipped_place = box.min();
  quality.flipped = flipped_triangles(finest, surface, input_tree, flipped_place);
  quality.flipped_at = fraction(flipped_place);
  quality.self_intersections = self_intersections(finest, std::vector<bool>(finest.triangles.size(), false)).size();
  quality.base_vertices = static_cast<int>(mesh.vertex_end.front());
  quality.levels = mesh.finest_level();
  return quality;
}

}  // namespace greenloop::offline
