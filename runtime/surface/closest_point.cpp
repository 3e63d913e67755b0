#include "runtime/surface/closest_point.hpp"

namespace greenloop {
namespace {

double squared(const Double3& a) { return dot(a, a); }

// share of b in the point of the segment a b that is nearest to the origin
double share_on_segment(const Double3& a, const Double3& b) {
  const Double3 along = b - a;
  const double length = squared(along), share = -dot(a, along);
  if (share <= 0) return 0;
  return share < length ? share / length : 1;
}

void take_edge(const Double3 (&corner)[3], int from, int to, ClosestPoint& least) {
  const double share = share_on_segment(corner[from], corner[to]);
  const double distance = squared((1 - share) * corner[from] + share * corner[to]);
  if (distance < least.squared_distance) {
    least = {{0, 0, 0}, distance};
    least.weight[from] = 1 - share;
    least.weight[to] = share;
  }
}

}  // namespace

ClosestPoint closest_to_origin(const Double3 (&corner)[3]) noexcept {
  ClosestPoint least{{1, 0, 0}, squared(corner[0])};
  for (int k = 0; k < 3; ++k) take_edge(corner, k, (k + 1) % 3, least);
  // areas that the foot of the perpendicular spans with the edges, times twice that of the triangle
  const Double3 first = corner[1] - corner[0], second = corner[2] - corner[0], foot = -corner[0];
  const Double3 normal = cross(first, second);
  const double whole = squared(normal), at_1 = dot(normal, cross(foot, second)), at_2 = dot(normal, cross(first, foot));
  const double at_0 = whole - at_1 - at_2;
  if (at_0 > 0 && at_1 > 0 && at_2 > 0) {
    const double w0 = at_0 / whole, w1 = at_1 / whole, w2 = at_2 / whole;
    const double distance = squared(w0 * corner[0] + w1 * corner[1] + w2 * corner[2]);
    if (distance < least.squared_distance) return {{w0, w1, w2}, distance};
  }
  return least;
}

}  // namespace greenloop
