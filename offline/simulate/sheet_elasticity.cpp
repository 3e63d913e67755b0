#include "offline/simulate/sheet_elasticity.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
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

double cotangent(const Vector3d& at, const Vector3d& to, const Vector3d& and_to) {
  const Vector3d u = to - at, v = and_to - at;
  return u.dot(v) / u.cross(v).norm();
}

}  // namespace

Vector3d SheetElasticity::Hinge::curvature(const Places& places) const {
  Vector3d sum = Vector3d::Zero();
  for (std::size_t i = 0; i < 4; ++i) sum += weights[i] * places[corners[i]];
  return sum;
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
    const double at_a = cotangent(x[a], x[b], x[c]), at_a_right = cotangent(x[a], x[b], x[d]);
    const double at_b = cotangent(x[b], x[a], x[c]), at_b_right = cotangent(x[b], x[a], x[d]);
    const double scale = std::sqrt(3 / sides.area);
    Hinge hinge{{a, b, c, d},
                {scale * (at_b + at_b_right), scale * (at_a + at_a_right), -scale * (at_a + at_b),
                 -scale * (at_a_right + at_b_right)}};
    hinge.bend = hinge.curvature(x).norm();
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
  const Vector3d curvature = hinge.curvature(places);
  const double bend = curvature.norm();
  if (!(bend > 0)) return;
  double mobile = bend_compliance_ / (time_step * time_step);
  for (std::size_t i = 0; i < 4; ++i) mobile += mobility(hinge.corners[i]) * hinge.weights[i] * hinge.weights[i];
  const Vector3d push = (hinge.bend - bend) / mobile / bend * curvature;
  for (std::size_t i = 0; i < 4; ++i) {
    places[hinge.corners[i]] += mobility(hinge.corners[i]) * hinge.weights[i] * push;
  }
}

void SheetElasticity::relax(double time_step, Places& places) const {
  for (const Spring& spring : springs_) relax(spring, time_step, places);
  for (const Hinge& hinge : hinges_) relax(hinge, time_step, places);
}

std::vector<double> lumped_masses(const TriangleMesh& mesh, double density) {
  std::vector<double> masses(mesh.vertices.size(), 0);
  for (const auto& t : mesh.triangles) {
    for (const int corner : t) masses[corner] += density * area_of(mesh, t) / 3;
  }
  return masses;
}

}  // namespace greenloop::offline
