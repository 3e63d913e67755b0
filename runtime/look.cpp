#include "runtime/look.hpp"

#include <cmath>

#include "runtime/algebra/double3.hpp"
#include "runtime/surface/parts.hpp"

namespace greenloop {
namespace {

Double3 exact(const Vec3& v) { return {v.x, v.y, v.z}; }

bool is_finite(const Look& look) {
  const float of[] = {look.eye.x,       look.eye.y,  look.eye.z,  look.direction.x, look.direction.y,
                      look.direction.z, look.cosine, look.detail, look.turned};
  bool finite = true;
  for (const float one : of) finite = finite && std::isfinite(one);
  return finite;
}

struct Corners {
  Double3 at[3];

  Corners(const SurfaceParts& surface, std::span<const Vec4> displacement, const Surface::Triangle& triangle) {
    for (int k = 0; k < 3; ++k) {
      const float* const x = surface.nodes[triangle.node[k]].position;
      at[k] = {x[0], x[1], x[2]};
      if (displacement.empty()) continue;
      const Vec4& u = displacement[triangle.node[k]];
      at[k] += Double3{u.x, u.y, u.z};
    }
  }

  [[nodiscard]] double squared_edge() const {
    double longest = 0;
    for (int k = 0; k < 3; ++k) {
      const Double3 edge = at[(k + 1) % 3] - at[k];
      longest = dot(edge, edge) > longest ? dot(edge, edge) : longest;
    }
    return longest;
  }
};

bool is_seen(const Corners& corners, const Look& look, double edge) {
  const Double3 normal = cross(corners.at[1] - corners.at[0], corners.at[2] - corners.at[0]);
  const Double3 way = corners.at[0] - exact(look.eye);
  const double distance = norm(way);
  const bool faces = dot(normal, way) <= double{look.turned} * norm(normal) * distance;
  // a corner is within an edge of all of the triangle
  const bool within = dot(exact(look.direction), way) >= double{look.cosine} * distance - edge || distance <= edge;
  return faces && within;
}

// after how many halvings an edge looks no longer than the detail
std::uint32_t halvings_of(double squared_edge, const Corners& corners, const Look& look) {
  const Double3 way = corners.at[0] - exact(look.eye);
  const double least = double{look.detail} * double{look.detail} * dot(way, way);
  std::uint32_t halvings = 0;
  for (; halvings < Seen::most_halvings && squared_edge > least; ++halvings) squared_edge *= 0.25;
  return halvings;
}

}  // namespace

Seen look_at(const Surface& surface, std::span<const Vec4> displacement, const Look& look,
             std::span<std::uint8_t> seen) noexcept {
  const std::uint32_t finest = surface.level();
  std::uint32_t level = 0;
  while (level <= finest && seen.size() != surface.triangle_count(level)) ++level;
  Seen all;
  if (level > finest || (!displacement.empty() && displacement.size() < surface.node_count(finest))) return all;
  for (std::uint8_t& one : seen) one = 0;
  if (!is_finite(look)) return all;
  const SurfaceParts& parts = surface.parts();
  const std::uint32_t halvings = 2 * (finest - level);
  for (std::uint32_t t = 0; t < surface.triangle_count(finest); ++t) {
    const Corners corners(parts, displacement, parts.triangles[t]);
    const double squared_edge = corners.squared_edge();
    if (!is_seen(corners, look, std::sqrt(squared_edge))) continue;
    std::uint8_t& flag = seen[t >> halvings];
    all.triangles += 1U - flag;
    flag = 1;
    const std::uint32_t needed = halvings_of(squared_edge, corners, look);
    all.halvings = needed > all.halvings ? needed : all.halvings;
  }
  return all;
}

}  // namespace greenloop
