#include "runtime/contact/cast.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace greenloop {
namespace {

constexpr double relative_slack = 0x1p-22;

double at(const Double3& v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

struct Segment {
  Double3 from, to;
};

// the part of it that lies in the box made `margin` larger; false if there is none
bool clip(const TriangleBox& box, double margin, Segment& segment) {
  const Double3 way = segment.to - segment.from;
  double first = 0, last = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const double begin = at(segment.from, axis), along = at(way, axis);
    const double low = box.low[axis] - margin, high = box.high[axis] + margin;
    if (along == 0) {
      if (begin < low || begin > high) return false;
      continue;
    }
    const double to_low = (low - begin) / along, to_high = (high - begin) / along;
    first = std::max(first, std::min(to_low, to_high));
    last = std::min(last, std::max(to_low, to_high));
  }
  if (!(first <= last)) return false;
  const Double3 from = segment.from;
  if (first > 0) segment.from = from + first * way;
  if (last < 1) segment.to = from + last * way;
  return true;
}

// Whether a box made `slack` larger may meet the segment: no axis of the box and none across both tells them apart
// (Ericson 2005, 5.3.3).
class BoxTest {
 public:
  BoxTest(const Segment& segment, double slack)
      : middle_(0.5 * (segment.from + segment.to)), half_(0.5 * (segment.to - segment.from)), slack_(slack) {
    reach_ = {std::abs(half_.x), std::abs(half_.y), std::abs(half_.z)};
  }

  [[nodiscard]] bool meets(const TriangleBox& box) const {
    const Double3 low{box.low[0], box.low[1], box.low[2]}, high{box.high[0], box.high[1], box.high[2]};
    const Double3 size = 0.5 * (high - low) + Double3{slack_, slack_, slack_}, c = middle_ - 0.5 * (high + low);
    if (std::abs(c.x) > size.x + reach_.x || std::abs(c.y) > size.y + reach_.y || std::abs(c.z) > size.z + reach_.z) {
      return false;
    }
    const Double3 across = cross(c, half_);
    return std::abs(across.x) <= size.y * reach_.z + size.z * reach_.y &&
           std::abs(across.y) <= size.x * reach_.z + size.z * reach_.x &&
           std::abs(across.z) <= size.x * reach_.y + size.y * reach_.x;
  }

 private:
  Double3 middle_, half_, reach_;
  double slack_;
};

// What is seen along the segment: places of the surface as points of a plane that the segment meets in its origin.
class View {
 public:
  View(const Segment& segment) : from_(segment.from) {
    const Double3 way = segment.to - segment.from;
    const double x = std::abs(way.x), y = std::abs(way.y), z = std::abs(way.z);
    depth_ = x >= y && x >= z ? 0 : y >= z ? 1 : 2;
    right_ = (depth_ + 1) % 3;
    up_ = (depth_ + 2) % 3;
    // seen along the way, whichever way that is
    if (at(way, depth_) < 0) std::swap(right_, up_);
    shear_right_ = at(way, right_) / at(way, depth_);
    shear_up_ = at(way, up_) / at(way, depth_);
  }

  /// Rounded to single precision: products of two are exact in double, so that signs of areas are.
  struct Seen {
    double right, up;
  };
  [[nodiscard]] Seen operator()(const Double3& place) const {
    const Double3 offset = place - from_;
    return {static_cast<float>(at(offset, right_) - shear_right_ * at(offset, depth_)),
            static_cast<float>(at(offset, up_) - shear_up_ * at(offset, depth_))};
  }

 private:
  Double3 from_;
  int depth_, right_, up_;
  double shear_right_ = 0, shear_up_ = 0;
};

// twice the area that the origin spans with an edge
double area(const View::Seen& a, const View::Seen& b) { return a.right * b.up - a.up * b.right; }

struct Crossing {
  TrianglePoint point;
  double share = 2;  ///< of the way; more than 1: none
};

class Cast {
 public:
  Cast(const DeformedSurface& surface, const Segment& segment, double slack)
      : surface_(surface), segment_(segment), view_(segment), slack_(slack) {}

  void look(std::uint32_t t) {
    const auto& [i, j, k] = surface_.triangle(t).node;
    const Double3 a = surface_.position(i), b = surface_.position(j), c = surface_.position(k);
    const View::Seen seen_a = view_(a), seen_b = view_(b), seen_c = view_(c);
    const double at_a = area(seen_b, seen_c), at_b = area(seen_c, seen_a), at_c = area(seen_a, seen_b);
    // clockwise from behind is counter-clockwise from outside: the way leads inwards
    const double whole = at_a + at_b + at_c;
    if (at_a > 0 || at_b > 0 || at_c > 0 || !(whole < 0)) return;
    const Double3 normal = unit(cross(b - a, c - a));
    const double before = dot(normal, segment_.from - a), behind = dot(normal, segment_.to - a);
    if (!(before >= -slack_) || !(behind < 0)) return;
    const double share = before > 0 ? before / (before - behind) : 0;
    if (share < first_.share || (share == first_.share && t < first_.point.triangle)) {
      first_ = {{t, {at_a / whole, at_b / whole, at_c / whole}}, share};
    }
  }

  [[nodiscard]] const TrianglePoint& first() const { return first_.point; }

 private:
  const DeformedSurface& surface_;
  Segment segment_;
  View view_;
  double slack_;
  Crossing first_;
};

// whether a triangle has all the corners of the one that a point lies in where the point has a weight
bool has(const Surface::Triangle& triangle, const Surface::Triangle& of, const TrianglePoint& point) {
  for (int k = 0; k < 3; ++k) {
    const auto& node = triangle.node;
    if (point.weight[k] > 0 && node[0] != of.node[k] && node[1] != of.node[k] && node[2] != of.node[k]) return false;
  }
  return true;
}

}  // namespace

TrianglePoint cast(const DeformedSurface& surface, const Double3& from, const Double3& to, const TrianglePoint& left,
                   std::uint64_t& work, std::uint64_t most) noexcept {
  work += SurfacePrices::query;
  const double slack = relative_slack * surface.extent();
  Segment segment{from, to};
  if (from == to || !clip(surface.box(), 4 * slack, segment)) return {};
  const BoxTest test(segment, slack);
  Cast way(surface, segment, slack);
  const auto meets = [&](const TriangleBox& box) {
    if (work > most) return false;
    work += SurfacePrices::box;
    return test.meets(box);
  };
  surface.visit(meets, [&](std::uint32_t patch) {
    for (const std::uint32_t t : surface.triangles_of(patch)) {
      work += SurfacePrices::triangle;
      const bool is_left =
          left.triangle != layout::none && has(surface.triangle(t), surface.triangle(left.triangle), left);
      if (!is_left) way.look(t);
    }
  });
  return way.first();
}

std::uint64_t cast_work(const DeformedSurface& surface) noexcept {
  return SurfacePrices::query + surface.box_count() * SurfacePrices::box +
         surface.triangle_count() * SurfacePrices::triangle;
}

}  // namespace greenloop
