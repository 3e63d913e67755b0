#include "runtime/surface/closest_point.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace greenloop {
namespace {

Double3 at(const Double3 (&corner)[3], const double (&weight)[3]) {
  return weight[0] * corner[0] + weight[1] * corner[1] + weight[2] * corner[2];
}

// no point of a fine raster over the triangle is nearer
double least_of_raster(const Double3 (&corner)[3], int steps) {
  double least = HUGE_VAL;
  for (int i = 0; i <= steps; ++i) {
    for (int j = 0; i + j <= steps; ++j) {
      const double a = double(i) / steps, b = double(j) / steps;
      const Double3 x = at(corner, {1 - a - b, a, b});
      least = std::min(least, dot(x, x));
    }
  }
  return least;
}

void check(const Double3 (&corner)[3]) {
  const ClosestPoint point = closest_to_origin(corner);
  for (const double weight : point.weight) {
    CHECK(weight >= 0);
    CHECK(weight <= 1);
  }
  CHECK(point.weight[0] + point.weight[1] + point.weight[2] == doctest::Approx(1).epsilon(1e-14));
  const Double3 x = at(corner, point.weight);
  CHECK(dot(x, x) == doctest::Approx(point.squared_distance).epsilon(1e-12));
  const double raster = least_of_raster(corner, 64);
  double longest = 0;
  for (int k = 0; k < 3; ++k) {
    const Double3 side = corner[k] - corner[(k + 1) % 3];
    longest = std::max(longest, std::sqrt(dot(side, side)));
  }
  CHECK(point.squared_distance <= raster * (1 + 1e-12));
  CHECK(std::sqrt(point.squared_distance) >= std::sqrt(raster) - longest / 64);
}

TEST_CASE("closest point: none of a raster is nearer, for random triangles, flat ones and points among them") {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> anywhere(-1, 1);
  const auto place = [&] { return Double3{anywhere(random), anywhere(random), anywhere(random)}; };
  for (int i = 0; i < 300; ++i) {
    const Double3 a = place(), b = place(), offset = 0.5 * place();
    const double share = anywhere(random);
    check({a + offset, b + offset, place() + offset});
    check({a, b, (1 - share) * a + share * b});
    check({a, a, b});
    check({a, a, a});
  }
}

TEST_CASE("closest point: the foot of the perpendicular, an edge or a corner, with their weights") {
  const auto weights = [](const Double3& from) {
    const Double3 corner[3] = {Double3{0, 0, 0} - from, Double3{4, 0, 0} - from, Double3{0, 4, 0} - from};
    return closest_to_origin(corner);
  };
  const ClosestPoint inside = weights({1, 2, 5});
  CHECK(inside.weight[0] == 0.25);
  CHECK(inside.weight[1] == 0.25);
  CHECK(inside.weight[2] == 0.5);
  CHECK(inside.squared_distance == 25);
  const ClosestPoint edge = weights({3, 3, 0});
  CHECK(edge.weight[0] == 0);
  CHECK(edge.weight[1] == 0.5);
  CHECK(edge.squared_distance == 2);
  const ClosestPoint corner = weights({-3, -4, 12});
  CHECK(corner.weight[0] == 1);
  CHECK(corner.squared_distance == 169);
  CHECK(weights({1, 1, 0}).squared_distance == 0);
}

}  // namespace
}  // namespace greenloop
