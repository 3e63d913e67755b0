#pragma once

#include <Eigen/Core>
#include <vector>

namespace greenloop::offline {

/// For each vertex the smallest index of a vertex at exactly the same position (itself if it is the first).
[[nodiscard]] std::vector<int> first_coincident_vertex(const std::vector<Eigen::Vector3d>& vertices);

}  // namespace greenloop::offline
