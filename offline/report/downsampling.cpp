#include "offline/report/downsampling.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace greenloop::offline {
namespace {

std::vector<Point> finite_points(const std::vector<Point>& curve) {
  std::vector<Point> finite;
  finite.reserve(curve.size());
  std::copy_if(curve.begin(), curve.end(), std::back_inserter(finite),
               [](const Point& point) { return std::isfinite(point.x) && std::isfinite(point.y); });
  return finite;
}

void append_extremes(const std::vector<Point>& points, std::size_t begin, std::size_t end, std::vector<Point>& kept) {
  const auto by_height = [](const Point& a, const Point& b) { return a.y < b.y; };
  const auto first = points.begin() + static_cast<std::ptrdiff_t>(begin);
  const auto last = points.begin() + static_cast<std::ptrdiff_t>(end);
  std::array<std::size_t, 4> chosen{
      begin, static_cast<std::size_t>(std::min_element(first, last, by_height) - points.begin()),
      static_cast<std::size_t>(std::max_element(first, last, by_height) - points.begin()), end - 1};
  std::sort(chosen.begin(), chosen.end());
  const auto* unique_end = std::unique(chosen.begin(), chosen.end());
  for (const auto* i = chosen.begin(); i != unique_end; ++i) kept.push_back(points[*i]);
}

}  // namespace

std::vector<Point> downsample(const std::vector<Point>& curve, int columns) {
  std::vector<Point> points = finite_points(curve);
  if (points.size() <= 4 * static_cast<std::size_t>(columns)) return points;
  const double x0 = points.front().x, per_column = (points.back().x - x0) / columns;
  std::vector<Point> kept;
  for (std::size_t begin = 0; begin < points.size();) {
    const double column = std::floor((points[begin].x - x0) / per_column);
    std::size_t end = begin + 1;
    while (end < points.size() && std::floor((points[end].x - x0) / per_column) == column) ++end;
    append_extremes(points, begin, end, kept);
    begin = end;
  }
  return kept;
}

std::vector<Point> staircase(const std::vector<Point>& curve) {
  std::vector<Point> stairs;
  const auto extend_tread = [&](double x) {
    const std::size_t n = stairs.size();
    if (n >= 2 && stairs[n - 2].y == stairs[n - 1].y) {
      stairs.back().x = x;
    } else {
      stairs.push_back({x, stairs.back().y});
    }
  };
  for (const Point& point : curve) {
    if (!stairs.empty()) extend_tread(point.x);
    if (stairs.empty() || stairs.back().y != point.y) stairs.push_back(point);
  }
  return stairs;
}

}  // namespace greenloop::offline
