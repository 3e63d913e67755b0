#include "runtime/contact/approach.hpp"

namespace greenloop {
namespace {

// m: nearer places of the tool's surface are on it
constexpr double touching = 1e-9;

// where on its way from one place of the tool's frame to another a place enters the shape, or the end of the way
struct Entry {
  Double3 at;
  SignedDistance distance;
  std::uint64_t advances = 0;
};

Entry find_entry(const Shape& shape, const Double3& from, const Double3& to) {
  const Double3 way = to - from;
  const double length = norm(way);
  Entry entry{from, shape.distance(from)};
  double gone = 0;
  for (int i = 0; i < most_advances && entry.distance.distance > touching; ++i) {
    ++entry.advances;
    gone += entry.distance.distance;
    const bool is_end = !(gone < length);
    entry.at = is_end ? to : from + (gone / length) * way;
    entry.distance = shape.distance(entry.at);
    if (is_end) break;
  }
  return entry;
}

}  // namespace

Approach approach(const Shape& shape, const Placement& last, const Placement& present, const Double3& place,
                  std::uint64_t& work) noexcept {
  const Double3 from = last.to_tool(place), to = present.to_tool(place);
  const Entry entry = find_entry(shape, from, to);
  work += approach_work(shape, entry.advances);
  const SignedDistance end = shape.distance(to);
  const bool is_free = end.distance > 0 && dot(entry.distance.normal, end.normal) >= 0;
  const SignedDistance& met = is_free ? end : entry.distance;
  const double gap = is_free ? end.distance : met.distance + dot(to - entry.at, met.normal);
  return {gap, present.turned(met.normal)};
}

}  // namespace greenloop
