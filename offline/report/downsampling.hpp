#pragma once

#include <vector>

#include "offline/report/svg_canvas.hpp"

namespace greenloop::offline {

/// A long curve with at most four points per column of `columns` equal intervals of its x range: the first, the lowest,
/// the highest and the last, in their order. What is drawn `columns` pixels wide looks the same as the whole curve.
/// `curve` has increasing x; points that are not finite are left out. Work: linear.
[[nodiscard]] std::vector<Point> downsample(const std::vector<Point>& curve, int columns);

/// The corners of a staircase that holds each y until the next x.
[[nodiscard]] std::vector<Point> staircase(const std::vector<Point>& curve);

}  // namespace greenloop::offline
