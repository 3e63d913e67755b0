#pragma once

#include <string>
#include <vector>

#include "offline/multigrid/block_matrix.hpp"
#include "offline/sources/fem/block_matrices.hpp"

namespace greenloop::bench {

/// Where a cube of side 1 m is stiffer than elsewhere.
enum class StiffPart {
  none,
  ball,          ///< of radius 0.3 m in the middle
  checkerboard,  ///< every second of 4 x 4 x 4 cells
};

/// A cube of side 1 m, held at x = 0 under its weight: E = 1 Pa, a kilonewton a cubic metre, and coarser meshes of it.
struct MultigridProblem {
  std::string name;
  StiffPart part;
  double contrast;  ///< E of the stiff part over E of the rest
  double poisson;
  TetrahedralMesh mesh;
  std::vector<TetrahedralMesh> coarser;  ///< from the second finest to the coarsest

  [[nodiscard]] offline::SolidMatter matter() const;
  [[nodiscard]] offline::FreeVertices free() const;
  /// Forces of the free vertices, N.
  [[nodiscard]] offline::BlockVector weight() const;
};

/// What the meshes of a problem are made by: halved cells cut into six tetrahedra, or Netgen at edges each 1.8 times as
/// long as on the finer level, so that no level is nested in another.
enum class Meshes { structured, netgen };

/// `cells` along an edge of the finest mesh, at least 2. Throws std::runtime_error where the mesher refuses.
[[nodiscard]] MultigridProblem multigrid_problem(Meshes meshes, int cells, StiffPart part, double contrast,
                                                 double poisson);

}  // namespace greenloop::bench
