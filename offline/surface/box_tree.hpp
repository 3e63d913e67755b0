#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <vector>

namespace greenloop::offline {

/// Calls visit(i, j) once for every unordered pair of boxes that overlap or touch, in an order that depends on the
/// boxes only, until it returns false. A bounding volume hierarchy split at medians: n log n work plus the pairs found
/// in reasonable scenes.
void for_each_overlap(const std::vector<Eigen::AlignedBox3d>& boxes, const std::function<bool(int, int)>& visit);

}  // namespace greenloop::offline
