#include "runtime/relief.hpp"

#include <cmath>

#include "runtime/surface/parts.hpp"

namespace greenloop {
namespace {

Double3 exact(const Vec3& v) { return {v.x, v.y, v.z}; }
Vec3 narrow(const Double3& v) { return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)}; }

bool has_node(const Surface& surface, std::uint32_t node) { return node < surface.node_count(surface.level()); }

// weights of a point in a triangle, and the child that it lies in: all at its next level
struct Descent {
  std::uint32_t triangle;
  double weight[3];

  void go_down() {
    std::uint32_t child = 3;
    for (std::uint32_t k = 0; k < 3; ++k) child = weight[k] > 0.5 ? k : child;
    const double before[3] = {weight[0], weight[1], weight[2]};
    for (std::uint32_t k = 0; k < 3; ++k) {
      weight[k] = child == 3 ? 1 - 2 * before[(k + 2) % 3] : 2 * before[k] - (k == child ? 1 : 0);
    }
    triangle = 4 * triangle + child;
  }
};

// of a contact's point at rest; 0 where it is none of the surface
Vec3 slope_under(const FinerSurface& surface, std::span<const Vec3> slope, const ContactBody::Contact& contact) {
  const Surface& coarse = surface.surface();
  if (!has_node(coarse, contact.node[0])) return {};
  if (contact.node[1] == layout::none) return slope[contact.node[0]];
  Double3 place;
  for (int k = 0; k < 3; ++k) {
    if (!has_node(coarse, contact.node[k])) continue;
    const float* const x = coarse.parts().nodes[contact.node[k]].position;
    place += contact.weight[k] * Double3{x[0], x[1], x[2]};
  }
  const Surface::NearestPoint nearest = coarse.nearest_point(narrow(place));
  return relief_slope(surface, slope, nearest.triangle, nearest.weight);
}

// friction of a contact over its relief
double friction_at(const Vec3& slope, double friction, const Double3& way, const Double3& normal) {
  constexpr double slow = 1e-6;  // m a step
  const Double3 along = way - dot(way, normal) * normal;
  const double squared = dot(along, along);
  const double uphill = dot(exact(slope), along) * std::sqrt(squared) / (squared + slow * slow);
  return friction + uphill > 0 ? friction + uphill : 0;
}

}  // namespace

bool relief_slopes(std::span<const Vec4> normal, std::span<const Vec3> detail, std::span<Vec3> slope) noexcept {
  if (normal.size() != detail.size() || normal.size() != slope.size()) return false;
  for (std::size_t i = 0; i < slope.size(); ++i) {
    const Double3 smooth{normal[i].x, normal[i].y, normal[i].z};
    const Double3 map = exact(detail[i]);
    const double upright = dot(smooth, map);
    const Double3 tangent = upright * smooth - map;
    const double along = norm(tangent);
    const bool is_usable = upright > 0 && std::isfinite(along) && std::isfinite(upright);
    const double steep = is_usable ? (along < upright * most_slope ? 1 / upright : most_slope / along) : 0;
    slope[i] = is_usable ? narrow(steep * tangent) : Vec3{};
  }
  return true;
}

Vec3 relief_slope(const FinerSurface& surface, std::span<const Vec3> slope, std::uint32_t triangle,
                  const float (&weight)[3]) noexcept {
  const std::uint32_t added = surface.added();
  if (slope.size() != surface.vertex_count(added) || triangle >= surface.triangle_count(0)) return {};
  Descent at{triangle, {weight[0], weight[1], weight[2]}};
  for (std::uint32_t k = 0; k < added; ++k) at.go_down();
  const Surface::Triangle corners = surface.triangle(added, at.triangle);
  Double3 sum;
  for (int k = 0; k < 3; ++k) sum += at.weight[k] * exact(slope[corners.node[k]]);
  return narrow(sum);
}

double relief_friction(const FinerSurface& surface, std::span<const Vec3> slope, double friction, const Double3& way,
                       std::span<const ContactBody::Contact> contacts) noexcept {
  if (slope.size() != surface.vertex_count(surface.added())) return friction;
  double sum = 0, pressed = 0;
  for (const ContactBody::Contact& contact : contacts) {
    const double force = dot(contact.force, contact.normal);
    if (!(force > 0)) continue;
    sum += force * friction_at(slope_under(surface, slope, contact), friction, way, contact.normal);
    pressed += force;
  }
  return pressed > 0 ? sum / pressed : friction;
}

}  // namespace greenloop
