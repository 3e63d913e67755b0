#include "offline/simulate/sheet_elasticity.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

namespace greenloop::offline {
namespace {

using Eigen::Vector3d;
using Edge = std::pair<int, int>;

/// The corners across an edge, and the area on its sides.
struct Sides {
  std::vector<int> across;
  double area = 0;
};

double area_of(const TriangleMesh& mesh, const std::array<int, 3>& t) {
  const Vector3d& a = mesh.vertices[t[0]];
  return (mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a).norm() / 2;
}

std::map<Edge, Sides> edges_of(const TriangleMesh& mesh) {
  std::map<Edge, Sides> edges;
  for (const auto& t : mesh.triangles) {
    for (int i = 0; i < 3; ++i) {
      Sides& sides = edges[std::minmax(t[i], t[(i + 1) % 3])];
      sides.across.push_back(t[(i + 2) % 3]);
      sides.area += area_of(mesh, t);
    }
  }
  return edges;
}

}  // namespace

HingeAngle hinge_angle(const std::array<Vector3d, 4>& places) {
  const auto& [a, b, c, d] = places;
  const Vector3d edge = b - a, left = edge.cross(c - a), right = (d - a).cross(edge);
  HingeAngle hinge;
  hinge.gradient.fill(Vector3d::Zero());
  const double length = edge.norm(), left_square = left.squaredNorm(), right_square = right.squaredNorm();
  if (!(left_square > 0) || !(right_square > 0)) return hinge;
  hinge.angle = std::atan2(left.cross(right).dot(edge) / length, left.dot(right));
  const Vector3d to_left = length / left_square * left, to_right = length / right_square * right;
  const double left_at = (c - a).dot(edge) / edge.squaredNorm(), right_at = (d - a).dot(edge) / edge.squaredNorm();
  hinge.gradient[0] = (1 - left_at) * to_left + (1 - right_at) * to_right;
  hinge.gradient[1] = left_at * to_left + right_at * to_right;
  hinge.gradient[2] = -to_left;
  hinge.gradient[3] = -to_right;
  return hinge;
}

SheetElasticity::SheetElasticity(const TriangleMesh& sewn, double stretch, double bend,
                                 const std::vector<double>& masses)
    : bend_compliance_(1 / bend) {
  for (const double mass : masses) mobilities_.push_back(mass > 0 ? 1 / mass : 0);
  const auto& x = sewn.vertices;
  for (const auto& [edge, sides] : edges_of(sewn)) {
    const auto [a, b] = edge;
    const double length = (x[b] - x[a]).norm();
    if (mobility(a) + mobility(b) > 0) springs_.push_back({a, b, length, length * length / (stretch * sides.area)});
    if (sides.across.size() != 2) continue;
    const int c = sides.across[0], d = sides.across[1];
    Hinge hinge{{a, b, c, d}, length * std::sqrt(3 / sides.area), 0};
    hinge.sewn = hinge_angle({x[a], x[b], x[c], x[d]}).angle;
    hinges_.push_back(hinge);
  }
}

void SheetElasticity::relax(const Spring& spring, double time_step, Places& places) const {
  const double a = mobility(spring.a), b = mobility(spring.b);
  Vector3d& from = places[spring.a];
  Vector3d& to = places[spring.b];
  const Vector3d along = to - from;
  const double length = along.norm();
  if (!(length > 0)) return;
  const double pull = (length - spring.length) / (a + b + spring.compliance / (time_step * time_step)) / length;
  from += a * pull * along;
  to -= b * pull * along;
}

void SheetElasticity::relax(const Hinge& hinge, double time_step, Places& places) const {
  std::array<Vector3d, 4> at;
  for (std::size_t i = 0; i < 4; ++i) at[i] = places[static_cast<std::size_t>(hinge.corners[i])];
  const HingeAngle now = hinge_angle(at);
  double turned = now.angle - hinge.sewn;  // the shorter way
  if (std::abs(turned) > std::numbers::pi) turned -= std::copysign(2 * std::numbers::pi, turned);
  double mobile = bend_compliance_ / (time_step * time_step) / (hinge.scale * hinge.scale);
  for (std::size_t i = 0; i < 4; ++i) mobile += mobility(hinge.corners[i]) * now.gradient[i].squaredNorm();
  for (std::size_t i = 0; i < 4; ++i) {
    places[hinge.corners[i]] -= mobility(hinge.corners[i]) * turned / mobile * now.gradient[i];
  }
}

void SheetElasticity::relax(double time_step, Places& places) const {
  for (const Spring& spring : springs_) relax(spring, time_step, places);
  for (const Hinge& hinge : hinges_) relax(hinge, time_step, places);
}

double SheetElasticity::largest_stretch(const Places& places) const {
  double most = 0;
  for (const Spring& spring : springs_) {
    const double stretch = (places[spring.b] - places[spring.a]).norm() / spring.length;
    if (!std::isfinite(stretch)) return std::numeric_limits<double>::infinity();
    most = std::max(most, stretch);
  }
  return most;
}

std::vector<double> lumped_masses(const TriangleMesh& mesh, double density) {
  std::vector<double> masses(mesh.vertices.size(), 0);
  for (const auto& t : mesh.triangles) {
    for (const int corner : t) masses[corner] += density * area_of(mesh, t) / 3;
  }
  return masses;
}

}  // namespace greenloop::offline
