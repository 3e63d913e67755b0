#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "formats/mesh/triangle_mesh.hpp"

namespace greenloop::offline {

/// Corners of a triangle that is not degenerate.
using Triangle = std::array<Eigen::Vector3d, 3>;

/// True if the two triangles have a point in common, boundaries included. Exact (see orientation.hpp).
[[nodiscard]] bool triangles_touch(const Triangle& s, const Triangle& t);

/// As many pairs of faces that intersect are looked for.
inline constexpr std::size_t most_pairs = 10'000;

/// As many pairs of faces whose boxes overlap are looked at, about ten seconds' work.
inline constexpr std::size_t most_looks = 100'000'000;

/// The pairs (f, g), f < g, of faces that have a point in common which is not part of their common vertex or edge.
/// Vertices at exactly the same position count as one. Faces marked in `skip` (one flag per face, e.g. those of zero
/// area) are left out. Ordered; not looked for any more once there are most_pairs. Work: n log n for a surface of n
/// faces few of which are near many others. Throws std::runtime_error after most_looks.
[[nodiscard]] std::vector<std::array<int, 2>> self_intersections(const TriangleMesh& mesh,
                                                                 const std::vector<bool>& skip);

}  // namespace greenloop::offline
