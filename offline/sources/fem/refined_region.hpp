#pragma once

#include <span>
#include <vector>

#include "offline/sources/fem/quadratic_elements.hpp"

namespace greenloop::offline {

/// Some tetrahedra of a mesh, each split into eight, with all of their displacement held that the others share.
struct RefinedRegion {
  TetrahedralMesh mesh;
  MeshEdges edges;
  Held held;
  QuadraticField displacement;  ///< the same function as on the whole
};

/// `tetrahedra`: numbers of those of the region. Work O(n log n).
[[nodiscard]] RefinedRegion refine_region(const TetrahedralMesh& mesh, const MeshEdges& edges, const Held& held,
                                          const QuadraticField& displacement, std::span<const int> tetrahedra);

}  // namespace greenloop::offline
