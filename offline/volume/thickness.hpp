#pragma once

#include <cstddef>
#include <vector>

#include "formats/mesh/semi_regular_mesh.hpp"
#include "formats/mesh/tetrahedral_mesh.hpp"
#include "formats/mesh/triangle_mesh.hpp"
#include "offline/volume/boundary_interpolation.hpp"

namespace greenloop::offline {

/// The straight way through a body from a surface node, inwards along its normal.
struct Chord {
  int triangle = -1;   ///< on the other side, of the finest level, then of the walls; -1: none was met
  double length = 0;   ///< m
  double spacing = 0;  ///< mean length of the edges at the node, m

  /// Elements as long as the node's edges that fit in; infinite where nothing was met.
  [[nodiscard]] double elements() const;
};

/// The chord of every node of a level, node by node: of the finest whose nodes times the finest triangles are at most
/// 3e8, or of the base. Their product is the work. `walls`: of cavities, looking into them.
[[nodiscard]] std::vector<Chord> inward_chords(const SemiRegularMesh& surface, const TriangleMesh& walls = {});

/// As many layers of tetrahedra are told apart.
inline constexpr int most_layers = 6;

/// Layers of tetrahedra along each chord: the fewest edges of the volume from one end to the other, at most
/// most_layers. `interpolation`: surface nodes from volume vertices. `walls`: those that the chords met, their vertices
/// the volume's.
[[nodiscard]] std::vector<double> layers_along(const std::vector<Chord>& chords, const SemiRegularMesh& surface,
                                               const TriangleMesh& walls, const TetrahedralMesh& volume,
                                               const Interpolation& interpolation);

/// Where fewest elements are across.
struct ThinnestPart {
  std::size_t node = 0;
  double elements = 0;
};

/// The node with fewest elements across it and across its neighbours, so that the tip of a wedge or of a cone, which is
/// thin at a node or two, does not count. `elements`: of all nodes of a level, as inward_chords has them.
[[nodiscard]] ThinnestPart thinnest_part(const SemiRegularMesh& surface, const std::vector<double>& elements);

}  // namespace greenloop::offline
