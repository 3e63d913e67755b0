#include "runtime/surface/shape.hpp"

#include <algorithm>
#include <cmath>

namespace greenloop {
namespace {

Double3 place(const SurfaceParts& parts, std::span<const Vec4> displacement, std::uint32_t node) {
  const float* x = parts.nodes[node].position;
  const Double3 rest{x[0], x[1], x[2]};
  if (displacement.empty()) return rest;
  const Vec4& u = displacement[node];
  return rest + Double3{u.x, u.y, u.z};
}

// calls visit(triangle, normal of the length of twice its area)
template <class Visit>
void visit_triangles(const SurfaceParts& parts, std::uint32_t level, std::span<const Vec4> displacement, Visit visit) {
  const std::uint32_t count = parts.base_triangles << (2 * level);
  for (std::uint32_t t = 0; t < count; ++t) {
    const Surface::Triangle triangle = triangle_of_level(parts, level, t);
    const Double3 a = place(parts, displacement, triangle.node[0]);
    visit(triangle,
          cross(place(parts, displacement, triangle.node[1]) - a, place(parts, displacement, triangle.node[2]) - a));
  }
}

}  // namespace

void write_normals(const SurfaceParts& parts, std::uint32_t level, std::span<const Vec4> displacement,
                   std::span<Vec4> normal) noexcept {
  std::fill(normal.begin(), normal.end(), Vec4{});
  visit_triangles(parts, level, displacement, [&](const Surface::Triangle& triangle, const Double3& area) {
    for (const std::uint32_t node : triangle.node) {
      normal[node].x += static_cast<float>(area.x);
      normal[node].y += static_cast<float>(area.y);
      normal[node].z += static_cast<float>(area.z);
    }
  });
  for (Vec4& sum : normal) {
    const Double3 exact{sum.x, sum.y, sum.z};
    const double length = std::sqrt(dot(exact, exact));
    const double scale = length > 0 ? 1 / length : 0;
    sum = {static_cast<float>(scale * exact.x), static_cast<float>(scale * exact.y),
           static_cast<float>(scale * exact.z), 0};
  }
}

void write_areas(const SurfaceParts& parts, std::uint32_t level, std::span<const Vec4> displacement,
                 std::span<float> area) noexcept {
  std::fill(area.begin(), area.end(), 0.0F);
  visit_triangles(parts, level, displacement, [&](const Surface::Triangle& triangle, const Double3& twice) {
    const auto third = static_cast<float>(std::sqrt(dot(twice, twice)) / 6);
    for (const std::uint32_t node : triangle.node) area[node] += third;
  });
}

}  // namespace greenloop
