#pragma once

#include <utility>
#include <vector>

#include "formats/exchange/triangle_mesh.hpp"

namespace greenloop::offline {

/// Pairs of triangles that meet elsewhere than in the vertices and edges they share, smaller index first, sorted.
/// Signs of volumes are filtered (Shewchuk 1997, first stage); what rounding cannot decide counts as touching, so a
/// surface reported clean is clean. Work: about linear times logarithm for surfaces.
[[nodiscard]] std::vector<std::pair<int, int>> self_intersections(const TriangleMesh& mesh);

}  // namespace greenloop::offline
