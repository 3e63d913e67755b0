#pragma once

#include <span>
#include <vector>

#include "formats/mesh/tetrahedral_mesh.hpp"
#include "offline/multigrid/galerkin.hpp"
#include "offline/volume/free_vertices.hpp"

namespace greenloop::offline {

/// Interpolation between the meshes of a hierarchy, which need be neither nested nor fill the same space (Georgii &
/// Westermann 2005, section 3.2.1): a vertex moves with the coarser level's tetrahedron around it, by its barycentric
/// coordinates, or outside with the nearest, whose linear displacement goes on there.
///
/// A vertex of stiff matter takes its displacement from vertices of the same piece alone, if need be by continuing a
/// tetrahedron of these beyond its faces. So the coarser level can move a stiff part as a rigid body and displace the
/// soft matter beside it at the same time, wherever its elements lie; plain interpolation, which bends the stiff part
/// with what is around, lets cycles stagnate. Where the coarser mesh has no tetrahedron of a piece, four of the piece's
/// vertices go to the coarser level as they are, and the others hang on them.
///
/// `free`: of the finest mesh's vertices. A coarser vertex is held, and made, as the nearest finer one. `young`: Pa, of
/// each of the finest tetrahedra. Coarser meshes from the second finest to the coarsest. Throws std::invalid_argument
/// on another number of moduli, a coarser mesh without tetrahedra or with one without volume, and a level of which no
/// vertex is free. Work: linear. Deterministic.
[[nodiscard]] std::vector<Prolongation> prolongations(const TetrahedralMesh& finest, const FreeVertices& free,
                                                      std::span<const double> young,
                                                      std::span<const TetrahedralMesh> coarser);

}  // namespace greenloop::offline
