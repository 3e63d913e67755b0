#pragma once

#include <string>

#include "formats/mesh/semi_regular_mesh.hpp"
#include "formats/mesh/tetrahedral_mesh.hpp"
#include "formats/mesh/triangle_mesh.hpp"
#include "offline/volume/tetrahedra_quality.hpp"

namespace greenloop::offline {

struct TetrahedralizeOptions {
  double interior_growth = 2.0;  ///< element size in the middle over the mean surface edge, 1..16
  double grading = 0.3;          ///< growth of the element size per distance from the surface, 0.1..0.8
  int optimization_steps = 3;    ///< smoothing and swapping rounds, 0..10
};

struct Tetrahedralization {
  TetrahedralMesh mesh;       ///< vertices 0..n-1 are the surface's, in order and bit for bit; interior ones follow
  TetrahedraQuality quality;  ///< measured on `mesh`
  std::string mesher;         ///< "netgen" or "tetgen"
};

/// Fills a closed surface with tetrahedra that keep every surface vertex and triangle and add interior nodes, whose
/// spacing grows from the surface's edge length inwards (a volume without them locks). Uses linked Netgen, up to three
/// times while there are slivers; when that fails, the separate program `tetgen`, if there is one on PATH.
/// Deterministic. The result is checked with require_fills_surface. Not reentrant: Netgen keeps global state, and
/// std::cout is muted meanwhile.
/// Throws std::invalid_argument on a surface that is open, faces inwards or intersects itself and on options out of
/// range, std::runtime_error when neither mesher succeeds.
[[nodiscard]] Tetrahedralization tetrahedralize(const TriangleMesh& surface, const TetrahedralizeOptions& options = {});

/// The finest level of a semi-regular surface as a triangle mesh, to be given to tetrahedralize.
[[nodiscard]] TriangleMesh finest_surface(const SemiRegularMesh& mesh);

}  // namespace greenloop::offline
