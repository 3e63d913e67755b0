#pragma once

#include <Eigen/Core>
#include <vector>

namespace greenloop::offline {

/// For each vertex the smallest index of a vertex at exactly the same position (itself if it is the first).
[[nodiscard]] std::vector<int> first_coincident_vertex(const std::vector<Eigen::Vector3d>& vertices);

/// For each vertex one within `distance` > 0 of it, itself if there is none before it: vertices are taken in order,
/// each goes to the nearest of those that went to themselves. A pair at most `distance` apart may thus stay two, if
/// each of them has a nearer one. Vertices with `considered` false stay alone. Work: linear.
[[nodiscard]] std::vector<int> first_vertex_within(const std::vector<Eigen::Vector3d>& vertices, double distance,
                                                   const std::vector<bool>& considered);

}  // namespace greenloop::offline
