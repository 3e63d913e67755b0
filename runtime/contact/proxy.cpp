#include "runtime/contact/proxy.hpp"

#include <algorithm>

#include "runtime/contact/cast.hpp"

namespace greenloop {
namespace {

// m: nearer to the surface the direction to it is lost in rounding
constexpr double touching = 1e-9;

bool is_inside_triangle(const TrianglePoint& point) {
  return point.weight[0] > 0 && point.weight[1] > 0 && point.weight[2] > 0;
}

}  // namespace

void Proxy::move(const DeformedSurface& surface, const Double3& to, double margin, std::uint64_t& work) noexcept {
  if (is_placed_) {
    if (!is_held_) enter(surface, to, work);
    if (is_held_) follow(surface, to, work);
  }
  if (!is_held_) settle(surface, to, margin, work);
  is_placed_ = true;
  last_ = to;
  if (point_.triangle != layout::none) measure(surface, to, work);
}

std::uint64_t Proxy::move_work(const DeformedSurface& surface) noexcept {
  const std::uint64_t slides = most_slides * surface.surround_work() + SurfacePrices::triangle;
  return 2 * surface.closest_work() + (1 + most_landings) * cast_work(surface) + most_landings * slides +
         (3 + most_landings) * surface.surround_work();
}

double Proxy::side(const DeformedSurface& surface, const Double3& of, std::uint64_t& work) const noexcept {
  return dot(of - surface.position(point_), surface.normal(point_, work));
}

// whether the surface has moved over the tool's point since the last step; then point_ is where it did
bool Proxy::was_overtaken(const DeformedSurface& surface, std::uint64_t& work) noexcept {
  if (point_.triangle == layout::none) {
    if (!surface.is_near(last_, 0)) return false;
    point_ = surface.closest(last_, layout::none, work).point;
  }
  return side(surface, last_, work) < 0;
}

void Proxy::enter(const DeformedSurface& surface, const Double3& to, std::uint64_t& work) noexcept {
  if (was_overtaken(surface, work)) {
    is_held_ = true;
    return;
  }
  const TrianglePoint entered = cast(surface, last_, to, {}, work);
  if (entered.triangle == layout::none) return;
  is_held_ = true;
  point_ = entered;
}

// where the tool's point is outside again, it is let go, unless on its way from the surface it enters another part
void Proxy::follow(const DeformedSurface& surface, const Double3& to, std::uint64_t& work) noexcept {
  for (int landing = 0; landing < most_landings; ++landing) {
    is_nearest_ = slide(surface, to, work);
    if (!is_nearest_ || !(side(surface, to, work) >= 0)) return;
    const TrianglePoint entered = cast(surface, surface.position(point_), to, point_, work);
    if (entered.triangle == layout::none) {
      is_held_ = false;
      return;
    }
    point_ = entered;
    is_nearest_ = false;
  }
}

// to the place nearest to the tool's point among all that ever nearer ones lead to; false if there are too many
bool Proxy::slide(const DeformedSurface& surface, const Double3& to, std::uint64_t& work) noexcept {
  ClosestSurfacePoint best = surface.closest_in(point_.triangle, to);
  work += SurfacePrices::triangle;
  bool is_nearest = false;
  for (std::uint32_t i = 0; i < most_slides && !is_nearest; ++i) {
    const TrianglePoint here = best.point;
    is_nearest = true;
    work += surface.around_work();
    surface.visit_around(here, [&](std::uint32_t t) {
      work += SurfacePrices::triangle;
      const ClosestSurfacePoint there = surface.closest_in(t, to);
      if (!(there.squared_distance < best.squared_distance)) return;
      best = there;
      is_nearest = false;
    });
  }
  point_ = best.point;
  return is_nearest;
}

void Proxy::settle(const DeformedSurface& surface, const Double3& to, double margin, std::uint64_t& work) noexcept {
  if (!surface.is_near(to, margin)) {
    point_ = {};
    return;
  }
  point_ = surface.closest(to, point_.triangle, work).point;
  is_nearest_ = true;
  is_held_ = side(surface, to, work) < 0;
}

void Proxy::measure(const DeformedSurface& surface, const Double3& to, std::uint64_t& work) noexcept {
  position_ = surface.position(point_);
  const Double3 way = to - position_;
  const double distance = norm(way);
  if (!is_nearest_ || is_inside_triangle(point_) || distance < touching) {
    normal_ = surface.normal(point_, work);
    height_ = dot(way, normal_);
    if (is_held_) height_ = std::min(height_, 0.0);
  } else {
    height_ = is_held_ ? -distance : distance;
    normal_ = (1 / height_) * way;
  }
}

}  // namespace greenloop
