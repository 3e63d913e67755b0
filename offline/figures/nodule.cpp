#include "offline/figures/nodule.hpp"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <utility>

namespace greenloop::offline {
namespace {

using Eigen::Vector3d;

constexpr double base_height = -0.012;  // m; what lies below is fixed

// with a vertex on the z axis, on the unit sphere
TriangleMesh icosahedron() {
  TriangleMesh mesh;
  const double height = 1 / std::sqrt(5.0), ring = 2 * height;
  mesh.vertices.emplace_back(0, 0, 1);
  for (const double side : {1.0, -1.0}) {
    for (int k = 0; k < 5; ++k) {
      const double azimuth = std::numbers::pi * (2 * k + (side < 0 ? 1 : 0)) / 5;
      mesh.vertices.emplace_back(ring * std::cos(azimuth), ring * std::sin(azimuth), side * height);
    }
  }
  mesh.vertices.emplace_back(0, 0, -1);
  for (int k = 0; k < 5; ++k) {
    const int a = 1 + k, b = 1 + (k + 1) % 5, c = 6 + k, d = 6 + (k + 1) % 5;
    mesh.triangles.push_back({0, a, b});
    mesh.triangles.push_back({a, c, b});
    mesh.triangles.push_back({b, c, d});
    mesh.triangles.push_back({c, 11, d});
  }
  return mesh;
}

TriangleMesh split(const TriangleMesh& coarse) {
  TriangleMesh fine{coarse.vertices, {}};
  std::map<std::pair<int, int>, int> middle_of;
  const auto middle = [&](int a, int b) {
    const auto [found, added] = middle_of.try_emplace(std::minmax(a, b), static_cast<int>(fine.vertices.size()));
    if (added) fine.vertices.push_back((fine.vertices[a] + fine.vertices[b]).normalized());
    return found->second;
  };
  for (const auto& [a, b, c] : coarse.triangles) {
    const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    for (const std::array<int, 3>& child : {std::array{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}}) {
      fine.triangles.push_back(child);
    }
  }
  return fine;
}

// m, of the body in a direction
double radius(double polar) {
  const double knob = std::exp(-polar * polar / 0.35);
  const double waist = std::exp(-(polar - 1.15) * (polar - 1.15) / 0.12);
  return 0.02 * (1 + 0.35 * knob - 0.12 * waist);
}

Vector3d on_body(const Vector3d& direction) {
  const double polar = std::acos(std::min(1.0, std::max(-1.0, direction.z())));
  return radius(polar) * direction;
}

}  // namespace

Vector3d nodule_point(double polar, double azimuth) {
  const double across = std::sin(polar);
  return radius(polar) * Vector3d(across * std::cos(azimuth), across * std::sin(azimuth), std::cos(polar));
}

Vector3d nodule_normal(double polar, double azimuth) {
  constexpr double step = 1e-6;
  const Vector3d down = nodule_point(polar + step, azimuth) - nodule_point(polar - step, azimuth);
  const Vector3d around(-std::sin(azimuth), std::cos(azimuth), 0);
  return down.cross(around).normalized();
}

Nodule make_nodule(const NoduleOptions& options) {
  Nodule nodule{icosahedron(), {}};
  for (int level = 0; level < options.splits; ++level) nodule.surface = split(nodule.surface);
  std::mt19937_64 random(options.seed);
  const auto uniform = [&] { return static_cast<double>(random() >> 11) * 0x1p-52 - 1; };
  const double most = options.uneven * mean_edge(nodule.surface);
  for (std::size_t v = 1; v < nodule.surface.vertices.size() && most > 0; ++v) {
    Vector3d& direction = nodule.surface.vertices[v];
    direction = (direction + most * Vector3d(uniform(), uniform(), uniform())).normalized();
  }
  for (Vector3d& vertex : nodule.surface.vertices) {
    vertex = on_body(vertex);
    nodule.fixed.push_back(vertex.z() < base_height ? 1 : 0);
  }
  return nodule;
}

double mean_edge(const TriangleMesh& surface) {
  double sum = 0;
  for (const std::array<int, 3>& triangle : surface.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      sum += (surface.vertices[triangle[k]] - surface.vertices[triangle[(k + 1) % 3]]).norm();
    }
  }
  return sum / (3.0 * static_cast<double>(surface.triangles.size()));
}

}  // namespace greenloop::offline
