#include "runtime/contact/proxy.hpp"

#include <algorithm>
#include <limits>

#include "runtime/contact/cast.hpp"

namespace greenloop {
namespace {

// m: nearer to the surface the direction to it is lost in rounding
constexpr double touching = 1e-9;

bool is_inside_triangle(const TrianglePoint& point) {
  return point.weight[0] > 0 && point.weight[1] > 0 && point.weight[2] > 0;
}

}  // namespace

void Proxy::move(const DeformedSurface& surface, const Double3& to, double margin, std::uint64_t& work,
                 std::uint64_t most) noexcept {
  const Proxy before = *this;
  const std::uint64_t kept = reserve(surface.sizes());
  const bool has_gone = most >= kept && work <= most - kept && go({surface, work, most - kept}, to, margin);
  if (!has_gone) *this = before;
  is_left_out_ = !has_gone;
  if (has_gone) {
    is_placed_ = true;
    last_ = to;
  } else if (!is_held_) {
    height_ = std::numeric_limits<double>::infinity();
    return;
  }
  if (point_.triangle != layout::none) measure(surface, to, work);
}

bool Proxy::go(const Query& query, const Double3& to, double margin) noexcept {
  if (is_placed_) {
    if (!is_held_ && !enter(query, to)) return false;
    if (is_held_ && !follow(query, to)) return false;
  }
  return is_held_ || settle(query, to, margin);
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
bool Proxy::was_overtaken(const Query& query) noexcept {
  if (point_.triangle == layout::none) {
    if (!query.surface.is_near(last_, 0)) return false;
    point_ = query.surface.closest(last_, layout::none, query.work, query.most).point;
    if (query.is_cut()) return false;
  }
  return side(query.surface, last_, query.work) < 0;
}

bool Proxy::enter(const Query& query, const Double3& to) noexcept {
  is_held_ = was_overtaken(query);
  if (is_held_ || query.is_cut()) return is_held_;
  const TrianglePoint entered = cast(query.surface, last_, to, {}, query.work, query.most);
  if (query.is_cut()) return false;
  if (entered.triangle == layout::none) return true;
  is_held_ = true;
  point_ = entered;
  return true;
}

// where the tool's point is outside again, it is let go, unless on its way from the surface it enters another part
bool Proxy::follow(const Query& query, const Double3& to) noexcept {
  for (int landing = 0; landing < most_landings; ++landing) {
    is_nearest_ = slide(query, to);
    if (!is_nearest_ || !(side(query.surface, to, query.work) >= 0)) return true;
    const TrianglePoint entered =
        cast(query.surface, query.surface.position(point_), to, point_, query.work, query.most);
    if (query.is_cut()) return false;
    if (entered.triangle == layout::none) {
      is_held_ = false;
      return true;
    }
    point_ = entered;
    is_nearest_ = false;
  }
  return true;
}

// to the place nearest to the tool's point among all that ever nearer ones lead to; false if there are too many
bool Proxy::slide(const Query& query, const Double3& to) noexcept {
  const DeformedSurface& surface = query.surface;
  ClosestSurfacePoint best = surface.closest_in(point_.triangle, to);
  query.work += SurfacePrices::triangle;
  bool is_nearest = false;
  for (std::uint32_t i = 0; i < most_slides && !is_nearest && !query.is_cut(); ++i) {
    const TrianglePoint here = best.point;
    is_nearest = true;
    query.work += surface.around_work();
    surface.visit_around(here, [&](std::uint32_t t) {
      query.work += SurfacePrices::triangle;
      const ClosestSurfacePoint there = surface.closest_in(t, to);
      if (!(there.squared_distance < best.squared_distance)) return;
      best = there;
      is_nearest = false;
    });
  }
  point_ = best.point;
  return is_nearest;
}

bool Proxy::settle(const Query& query, const Double3& to, double margin) noexcept {
  if (!query.surface.is_near(to, margin)) {
    point_ = {};
    return true;
  }
  point_ = query.surface.closest(to, point_.triangle, query.work, query.most).point;
  if (query.is_cut()) return false;
  is_nearest_ = true;
  is_held_ = side(query.surface, to, query.work) < 0;
  return true;
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
