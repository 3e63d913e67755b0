#pragma once

#include <vector>

#include "formats/mesh/triangle_mesh.hpp"

namespace greenloop::offline {

/// Lumped area a_j of every surface vertex, m^2: a third of its triangles' areas (the integral of its hat function).
[[nodiscard]] std::vector<double> lumped_areas(const TriangleMesh& surface);

}  // namespace greenloop::offline
