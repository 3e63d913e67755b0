#include "sim_hw/device/touch_place.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace greenloop {
namespace {

Double3 touchable_centre(const BodySurface& surface) {
  Double3 sum;
  double count = 0;
  for (std::size_t i = 0; i < surface.position.size(); ++i) {
    if (!surface.touchable[i]) continue;
    sum += surface.position[i];
    ++count;
  }
  return (1 / count) * sum;
}

/// The 13 axes of a cube through its faces, edges and corners.
std::vector<Double3> axes() {
  std::vector<Double3> all;
  for (int x = 1; x >= -1; --x) {
    for (int y = 1; y >= -1; --y) {
      for (int z = 1; z >= -1; --z) {
        const bool first_half = x > 0 || (x == 0 && (y > 0 || (y == 0 && z > 0)));
        if (first_half) all.push_back(unit({double(x), double(y), double(z)}));
      }
    }
  }
  return all;
}

std::vector<TouchPlace> candidates(const BodySurface& surface, double radius) {
  std::vector<TouchPlace> found;
  const auto add = [&](const Double3& point, const Double3& outward) {
    if (const auto place = lower_sphere(surface, radius, point, outward)) found.push_back(*place);
  };
  const Double3 centre = touchable_centre(surface);
  for (const Double3& axis : axes()) {
    add(centre, axis);
    add(centre, -axis);
  }
  // a small or hollow patch: try above each of its nodes
  for (std::size_t i = 0; i < surface.position.size() && found.empty(); ++i) {
    if (surface.touchable[i]) add(surface.position[i], surface.normal[i]);
  }
  return found;
}

double distance_to_nearest(const TouchPlace& place, const std::vector<TouchPlace>& others) {
  double nearest = norm(place.centre - others.front().centre);
  for (const TouchPlace& other : others) nearest = std::min(nearest, norm(place.centre - other.centre));
  return nearest;
}

/// Places from `start` onwards in steps of `step`, as long as they neither jump nor end.
std::vector<TouchPlace> walk(const BodySurface& surface, double radius, const TouchPlace& start, const Double3& step,
                             int steps) {
  std::vector<TouchPlace> row;
  double height = dot(start.centre, start.outward);
  for (int i = 1; i <= steps; ++i) {
    const auto place = lower_sphere(surface, radius, start.centre + static_cast<double>(i) * step, start.outward);
    if (!place || std::abs(dot(place->centre, start.outward) - height) > norm(step)) break;
    height = dot(place->centre, start.outward);
    row.push_back(*place);
  }
  return row;
}

}  // namespace

std::optional<TouchPlace> lower_sphere(const BodySurface& surface, double radius, const Double3& point,
                                       const Double3& outward, double least_facing) {
  std::optional<TouchPlace> first;
  double highest = 0;
  for (std::size_t i = 0; i < surface.position.size(); ++i) {
    const Double3 offset = surface.position[i] - point;
    const double along = dot(offset, outward);
    const double beside = dot(offset, offset) - along * along;
    if (beside >= radius * radius) continue;
    const double height = along + std::sqrt(radius * radius - beside);
    if (first && height <= highest) continue;
    highest = height;
    first =
        TouchPlace{point + height * outward, outward, static_cast<std::uint32_t>(i), dot(surface.normal[i], outward)};
  }
  if (first && (!surface.touchable[first->node] || first->facing < least_facing)) first.reset();
  return first;
}

std::vector<TouchPlace> touch_places(const BodySurface& surface, double radius, std::size_t most) {
  const std::vector<TouchPlace> all = candidates(surface, radius);
  if (all.empty()) {
    throw std::runtime_error("model: a probe of radius " + std::to_string(radius) +
                             " m reaches no touchable node from outside; make more of the surface touchable");
  }
  std::vector<TouchPlace> chosen{all.front()};
  while (chosen.size() < std::min(most, all.size())) {
    chosen.push_back(*std::max_element(all.begin(), all.end(), [&](const TouchPlace& a, const TouchPlace& b) {
      return distance_to_nearest(a, chosen) < distance_to_nearest(b, chosen);
    }));
  }
  return chosen;
}

std::optional<std::array<TouchPlace, 2>> opposing_places(const BodySurface& surface, double radius) {
  std::optional<std::array<TouchPlace, 2>> best;
  double best_facing = 0;
  const Double3 centre = touchable_centre(surface);
  for (const Double3& axis : axes()) {
    const auto one = lower_sphere(surface, radius, centre, axis), other = lower_sphere(surface, radius, centre, -axis);
    if (!one || !other || std::min(one->facing, other->facing) <= best_facing) continue;
    best_facing = std::min(one->facing, other->facing);
    best = {*one, *other};
  }
  if (best) return best;
  const std::vector<TouchPlace> places = touch_places(surface, radius, 8);
  double most_opposite = 2;
  for (std::size_t i = 0; i < places.size(); ++i) {
    for (std::size_t j = i + 1; j < places.size(); ++j) {
      const double cosine = dot(places[i].outward, places[j].outward);
      if (cosine >= most_opposite || norm(places[i].centre - places[j].centre) < 2 * radius) continue;
      most_opposite = cosine;
      best = {places[i], places[j]};
    }
  }
  return best;
}

std::vector<TouchPlace> sliding_row(const BodySurface& surface, double radius, double length,
                                    const std::vector<TouchPlace>& starts) {
  constexpr int steps = 8;
  std::vector<TouchPlace> longest;
  for (const TouchPlace& start : starts) {
    const Double3 first = perpendicular(start.outward);
    for (const Double3& tangent : {first, cross(start.outward, first)}) {
      const Double3 step = (length / steps) * tangent;
      std::vector<TouchPlace> row = walk(surface, radius, start, -step, steps);
      std::reverse(row.begin(), row.end());
      row.push_back(start);
      for (const TouchPlace& place : walk(surface, radius, start, step, steps)) row.push_back(place);
      if (row.size() > longest.size()) longest = row;
    }
  }
  return longest;
}

}  // namespace greenloop
