#include "runtime/contact/tool.hpp"

#include <algorithm>
#include <cmath>

namespace greenloop {
namespace {

constexpr double largest = 1e6;
constexpr Double3 upwards{0, 0, 1};

bool is_size(double size) { return size > 0 && size <= largest; }

// from a point, with `radius` around it
SignedDistance from_point(const Double3& way, double radius) {
  const double distance = norm(way);
  return {distance - radius, distance > 0 ? (1 / distance) * way : upwards};
}

double beyond(double coordinate, double half) { return coordinate - std::clamp(coordinate, -half, half); }

double sign(double value) { return value < 0 ? -1 : 1; }

SignedDistance from_box(const Double3& place, const Double3& half) {
  const Double3 way{beyond(place.x, half.x), beyond(place.y, half.y), beyond(place.z, half.z)};
  if (way.x != 0 || way.y != 0 || way.z != 0) return from_point(way, 0);
  const double x = half.x - std::abs(place.x), y = half.y - std::abs(place.y), z = half.z - std::abs(place.z);
  if (x <= y && x <= z) return {-x, {sign(place.x), 0, 0}};
  if (y <= z) return {-y, {0, sign(place.y), 0}};
  return {-z, {0, 0, sign(place.z)}};
}

double to_infinity(double direction) { return direction > 0 ? HUGE_VAL : direction < 0 ? -HUGE_VAL : 0; }

Double3 support_of_plane(const Double3& direction) {
  return {to_infinity(direction.x), to_infinity(direction.y), direction.z < 0 ? -HUGE_VAL : 0};
}

Double3 support_of(std::span<const Double3> vertices, const Double3& direction) {
  Double3 farthest = vertices[0];
  for (const Double3& v : vertices) {
    if (dot(v, direction) > dot(farthest, direction)) farthest = v;
  }
  return farthest;
}

}  // namespace

Shape Shape::sphere(double radius) noexcept {
  Shape shape;
  shape.kind_ = Kind::sphere;
  shape.radius_ = radius;
  return shape;
}

Shape Shape::capsule(double radius, double half_length) noexcept {
  Shape shape = sphere(radius);
  shape.kind_ = Kind::capsule;
  shape.half_.z = half_length;
  return shape;
}

Shape Shape::box(const Double3& half) noexcept {
  Shape shape;
  shape.kind_ = Kind::box;
  shape.half_ = half;
  return shape;
}

Shape Shape::plane() noexcept {
  Shape shape;
  shape.kind_ = Kind::plane;
  return shape;
}

Shape Shape::polyhedron(const ConvexPolyhedron& polyhedron) noexcept {
  Shape shape;
  shape.kind_ = Kind::polyhedron;
  shape.polyhedron_ = polyhedron;
  return shape;
}

Shape::Error Shape::check() const noexcept {
  bool good = true;
  switch (kind_) {
    case Kind::sphere:
      good = is_size(radius_);
      break;
    case Kind::capsule:
      good = is_size(radius_) && half_.z >= 0 && half_.z <= largest;
      break;
    case Kind::box:
      good = is_size(half_.x) && is_size(half_.y) && is_size(half_.z);
      break;
    case Kind::polyhedron:
      return polyhedron_.face_count() > 0 ? Error::none : Error::no_polyhedron;
    case Kind::point:
    case Kind::plane:
      break;
  }
  return good ? Error::none : Error::bad_size;
}

SignedDistance Shape::distance(const Double3& place) const noexcept {
  switch (kind_) {
    case Kind::capsule:
      return from_point(place - Double3{0, 0, std::clamp(place.z, -half_.z, half_.z)}, radius_);
    case Kind::box:
      return from_box(place, half_);
    case Kind::plane:
      return {place.z, upwards};
    case Kind::polyhedron:
      return polyhedron_.distance(place);
    case Kind::point:
    case Kind::sphere:
      break;
  }
  return from_point(place, radius_);
}

std::uint64_t Shape::distance_work() const noexcept {
  constexpr std::uint64_t simple = 40, face = 120;
  return kind_ == Kind::polyhedron ? simple + face * polyhedron_.face_count() : simple;
}

Double3 Shape::support(const Double3& direction) const noexcept {
  switch (kind_) {
    case Kind::capsule:
      return Double3{0, 0, direction.z < 0 ? -half_.z : half_.z} + radius_ * unit(direction);
    case Kind::box:
      return {sign(direction.x) * half_.x, sign(direction.y) * half_.y, sign(direction.z) * half_.z};
    case Kind::plane:
      return support_of_plane(direction);
    case Kind::polyhedron:
      return support_of(polyhedron_.vertices(), direction);
    case Kind::point:
    case Kind::sphere:
      break;
  }
  return radius_ * unit(direction);
}

double Shape::bounding_radius() const noexcept {
  switch (kind_) {
    case Kind::capsule:
      return radius_ + half_.z;
    case Kind::box:
      return norm(half_);
    case Kind::plane:
      return HUGE_VAL;
    case Kind::polyhedron:
      break;
    case Kind::point:
    case Kind::sphere:
      return radius_;
  }
  double radius = 0;
  for (const Double3& v : polyhedron_.vertices()) radius = std::max(radius, norm(v));
  return radius;
}

std::uint32_t Shape::point_count() const noexcept {
  switch (kind_) {
    case Kind::capsule: {
      // limited while still a real number: a thin capsule's would not fit an integer
      const double gaps = std::min(2 * half_.z / radius_, double{max_axis_points - 1});
      const auto whole = static_cast<std::uint32_t>(gaps);
      return whole + (whole < gaps ? 2 : 1);
    }
    case Kind::box:
      return 8;
    case Kind::plane:
      return 0;
    case Kind::polyhedron:
      return static_cast<std::uint32_t>(polyhedron_.vertices().size());
    case Kind::point:
    case Kind::sphere:
      break;
  }
  return 1;
}

Double3 Shape::point(std::uint32_t i) const noexcept {
  switch (kind_) {
    case Kind::capsule: {
      const std::uint32_t last = point_count() - 1;
      return {0, 0, last > 0 ? half_.z * (2.0 * i / last - 1) : 0};
    }
    case Kind::box: {
      const auto side = [i](std::uint32_t bit, double half) { return (i & bit) != 0 ? half : -half; };
      return {side(1, half_.x), side(2, half_.y), side(4, half_.z)};
    }
    case Kind::polyhedron:
      return polyhedron_.vertices()[i];
    case Kind::point:
    case Kind::sphere:
    case Kind::plane:
      break;
  }
  return {};
}

}  // namespace greenloop
