#include "offline/report/downsampling.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace greenloop::offline {

TEST_CASE("downsampling keeps every extreme of every column, and the order") {
  std::mt19937_64 random(3);
  INFO("seed 3");
  std::vector<Point> curve;
  curve.reserve(20'000);
  for (int i = 0; i < 20'000; ++i) curve.push_back({i * 1e-3, std::ldexp(static_cast<double>(random()), -64)});
  curve[12'345].y = 50;   // a spike one cycle long must survive
  curve[17'000].y = -20;  // so must a dip
  const auto kept = downsample(curve, 500);
  CHECK(kept.size() <= 4 * 501);
  CHECK(std::is_sorted(kept.begin(), kept.end(), [](const Point& a, const Point& b) { return a.x < b.x; }));
  const auto has = [&](const Point& point) {
    return std::any_of(kept.begin(), kept.end(), [&](const Point& p) { return p.x == point.x && p.y == point.y; });
  };
  CHECK(has(curve[12'345]));
  CHECK(has(curve[17'000]));
  CHECK(has(curve.front()));
  CHECK(has(curve.back()));
}

TEST_CASE("a short curve stays whole, but for what is not finite") {
  const std::vector<Point> curve{{0, 1}, {1, std::nan("")}, {2, std::numeric_limits<double>::infinity()}, {3, 4}};
  const auto kept = downsample(curve, 10);
  REQUIRE(kept.size() == 2);
  CHECK(kept[1].y == 4);
  CHECK(downsample({}, 10).empty());
}

TEST_CASE("points of one single x do not divide by zero") {
  const std::vector<Point> curve(100, Point{1, 2});
  CHECK(downsample(curve, 10).size() <= 100);
  CHECK_FALSE(downsample(curve, 10).empty());
}

TEST_CASE("a staircase holds each value until the next and drops what lies on a tread") {
  const auto stairs = staircase({{0, 1}, {1, 1}, {2, 1}, {3, 4}, {4, 4}});
  REQUIRE(stairs.size() == 4);
  CHECK(stairs[1].x == 3);
  CHECK(stairs[1].y == 1);
  CHECK(stairs[2].x == 3);
  CHECK(stairs[2].y == 4);
  CHECK(stairs[3].x == 4);
}

}  // namespace greenloop::offline
