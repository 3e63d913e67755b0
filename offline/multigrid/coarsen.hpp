#pragma once

#include <string>
#include <vector>

#include "formats/mesh/tetrahedral_mesh.hpp"
#include "formats/mesh/triangle_mesh.hpp"

namespace greenloop::offline {

/// Meshes of a hierarchy below a given one.
struct CoarserMeshes {
  std::vector<TetrahedralMesh> meshes;  ///< from the second finest to the coarsest
  std::string note;                     ///< where the mesher refused a level and lattices follow; else empty
};

/// Coarser meshes of a body down to `coarsest` vertices or fewer: each surface the one before decimated to a quarter of
/// its vertices and filled with tetrahedra anew, so that levels are not nested; first the surface as it is where
/// `finest` has four times its vertices, as by refined(). From a level on that the mesher refuses, or that is hardly
/// coarser than the one before, lattices of twice its spacing each. `surface`: of the body `finest`, closed, as
/// tetrahedralize takes it; `coarsest`: at least 8. Deterministic.
[[nodiscard]] CoarserMeshes coarsen(const TriangleMesh& surface, const TetrahedralMesh& finest, std::size_t coarsest);

/// Cubes of edge `spacing` wherever a mesh has vertices, each cut into six tetrahedra: a coarser level of any body,
/// which it covers but does not fit. Work: vertices, log cubes each. Throws std::invalid_argument where spacing is not
/// above 0 or a millionth of the body.
[[nodiscard]] TetrahedralMesh lattice(const TetrahedralMesh& mesh, double spacing);

/// Each tetrahedron cut into eight at the middles of its edges, four at its corners and four around the shortest
/// diagonal of what is left (Bey 1995): a finer level in which the given one is nested. Its vertices come first.
/// Work: edges, log edges each.
[[nodiscard]] TetrahedralMesh refined(const TetrahedralMesh& mesh);

}  // namespace greenloop::offline
