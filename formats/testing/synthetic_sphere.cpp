#include "formats/testing/synthetic_sphere.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace greenloop {
namespace {

using Sphere = SyntheticSphere;
using Point = Sphere::Point;
using Triangle = Sphere::Triangle;

constexpr double fixed_below = -0.5;  // in radii, as is the next
constexpr double unneeded_below = -0.2;
constexpr double linear_below = -0.3;

std::uint32_t flags_at(double height, bool finest_of_several, double touchable_above) {
  if (height < fixed_below) return layout::node_fixed;
  if (finest_of_several && height < unneeded_below) return 0;
  const bool touchable = height >= touchable_above;
  return layout::node_domain | layout::node_read | (touchable ? static_cast<std::uint32_t>(layout::node_touchable) : 0);
}

// Adds a level's nodes, domain first; returns the new index of each.
std::vector<std::uint32_t> add_level(Sphere& sphere, const std::vector<Point>& points, bool finest_of_several,
                                     double touchable_above) {
  std::vector<std::uint32_t> index(points.size());
  for (const bool domain : {true, false}) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const std::uint32_t flags = flags_at(points[i][2] / Sphere::radius, finest_of_several, touchable_above);
      if (((flags & layout::node_domain) != 0) != domain) continue;
      index[i] = static_cast<std::uint32_t>(sphere.positions.size());
      sphere.positions.push_back(points[i]);
      sphere.flags.push_back(flags);
    }
  }
  sphere.begin.push_back(static_cast<std::uint32_t>(sphere.positions.size()));
  return index;
}

using Edge = std::pair<std::uint32_t, std::uint32_t>;

// the third corners of the triangles at every edge
std::map<Edge, std::vector<std::uint32_t>> opposite_corners(const std::vector<Triangle>& triangles) {
  std::map<Edge, std::vector<std::uint32_t>> corners;
  for (const Triangle& t : triangles) {
    for (std::size_t k = 0; k < 3; ++k) corners[std::minmax(t[k], t[(k + 1) % 3])].push_back(t[(k + 2) % 3]);
  }
  return corners;
}

// of a new node on the edge (a, b) of `triangles`
layout::StencilRecord stencil_of(std::map<Edge, std::vector<std::uint32_t>>& corners, std::uint32_t a,
                                 std::uint32_t b) {
  const auto across = [&](std::uint32_t from, std::uint32_t wing, std::uint32_t other) {
    const auto& both = corners[std::minmax(from, wing)];
    return both[both[0] == other ? 1 : 0];
  };
  const auto& wing = corners[std::minmax(a, b)];
  return {{wing[0], wing[1]},
          {across(a, wing[0], b), across(b, wing[0], a), across(a, wing[1], b), across(b, wing[1], a)}};
}

void split(Sphere& sphere, bool finest, double touchable_above) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> odd;
  std::vector<Point> points;
  std::vector<std::array<std::uint32_t, 2>> ends;
  const auto middle = [&](std::uint32_t a, std::uint32_t b) {
    const auto [found, is_new] = odd.try_emplace({std::min(a, b), std::max(a, b)}, points.size());
    if (is_new) {
      Point x;
      for (std::size_t k = 0; k < 3; ++k) x[k] = sphere.positions[a][k] + sphere.positions[b][k];
      const double scale = Sphere::radius / distance(x, {});
      for (double& value : x) value *= scale;
      points.push_back(x);
      ends.push_back({found->first.first, found->first.second});
    }
    return found->second;
  };
  std::vector<std::array<std::size_t, 3>> middles;
  for (const Triangle& t : sphere.finest) {
    middles.push_back({middle(t[0], t[1]), middle(t[1], t[2]), middle(t[2], t[0])});
  }
  const auto index = add_level(sphere, points, finest, touchable_above);
  sphere.parents.resize(sphere.positions.size());
  sphere.stencils.resize(sphere.positions.size());
  auto corners = opposite_corners(sphere.finest);
  for (std::size_t i = 0; i < ends.size(); ++i) {
    sphere.parents[index[i]] = ends[i];
    sphere.stencils[index[i]] = stencil_of(corners, ends[i][0], ends[i][1]);
  }
  std::vector<Triangle> children;
  for (std::size_t i = 0; i < middles.size(); ++i) {
    const auto [a, b, c] = sphere.finest[i];
    const std::uint32_t ab = index[middles[i][0]], bc = index[middles[i][1]], ca = index[middles[i][2]];
    for (const Triangle& t : {Triangle{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}}) children.push_back(t);
  }
  sphere.finest = std::move(children);
}

void measure_areas(Sphere& sphere) {
  sphere.areas.assign(sphere.count(), 0);
  for (const Triangle& t : sphere.finest) {
    const double a = distance(sphere.positions[t[0]], sphere.positions[t[1]]);
    const double b = distance(sphere.positions[t[1]], sphere.positions[t[2]]);
    const double c = distance(sphere.positions[t[2]], sphere.positions[t[0]]);
    const double half = (a + b + c) / 2;  // Heron's formula
    const double area = std::sqrt(half * (half - a) * (half - b) * (half - c));
    for (const std::uint32_t node : t) sphere.areas[node] += area / 3;
  }
}

}  // namespace

double distance(const Point& x, const Point& y) { return std::hypot(x[0] - y[0], x[1] - y[1], x[2] - y[2]); }

Sphere make_sphere(std::uint32_t levels, double touchable_above) {
  Sphere sphere;
  const double r = Sphere::radius;
  const std::vector<Point> corners = {{r, 0, 0}, {-r, 0, 0}, {0, r, 0}, {0, -r, 0}, {0, 0, r}, {0, 0, -r}};
  const auto index = add_level(sphere, corners, false, touchable_above);
  for (const auto& t :
       {Triangle{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}) {
    sphere.base.push_back({index[t[0]], index[t[1]], index[t[2]]});
  }
  sphere.finest = sphere.base;
  for (std::uint32_t q = 1; q < levels; ++q) split(sphere, q + 1 == levels, touchable_above);
  measure_areas(sphere);
  return sphere;
}

bool uses_stencil(const Sphere& sphere, std::uint32_t node) {
  return sphere.positions[node][2] >= linear_below * Sphere::radius;
}

// The lifting weight of every node towards its parents.
std::vector<std::array<double, 2>> lifting_weights(const Sphere& sphere, bool butterfly) {
  std::vector<double> integral = sphere.areas;
  std::vector<std::array<double, 2>> lift(sphere.count());
  for (std::uint32_t q = sphere.levels() - 1; q > 0; --q) {
    for (std::uint32_t m = sphere.begin[q]; m < sphere.begin[q + 1]; ++m) {
      for (const std::uint32_t parent : sphere.parents[m]) integral[parent] += integral[m] / 2;
      if (!butterfly || !uses_stencil(sphere, m)) continue;
      for (const std::uint32_t wing : sphere.stencils[m].wing) integral[wing] += integral[m] / 8;
      for (const std::uint32_t outer : sphere.stencils[m].outer) integral[outer] -= integral[m] / 16;
    }
    for (std::uint32_t m = sphere.begin[q]; m < sphere.begin[q + 1]; ++m) {
      for (std::size_t k = 0; k < 2; ++k) {
        const std::uint32_t parent = sphere.parents[m][k];
        const bool lifted = sphere.has(m, layout::node_domain) && sphere.has(parent, layout::node_domain);
        lift[m][k] = lifted ? integral[m] / (2 * integral[parent]) : 0;
      }
    }
  }
  return lift;
}

}  // namespace greenloop
