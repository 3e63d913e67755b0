#pragma once

#include <span>

#include "formats/mesh/tetrahedral_mesh.hpp"
#include "offline/multigrid/block_matrix.hpp"
#include "offline/volume/free_vertices.hpp"

namespace greenloop::bench {

/// Conjugate gradients on PETSc's algebraic multigrid (GAMG, its defaults) with the rigid motions as near nullspace,
/// from 0 until the residual is `tolerance` of the right side, on one thread.
class PetscGamg {
 public:
  /// Whether it is installed.
  [[nodiscard]] static bool available();

  struct Answer {
    bool solved = false;              ///< by what PETSc says
    double setup_s = 0, solve_s = 0;  ///< thread CPU time
    int iterations = 0;
    offline::BlockVector x;
  };
  [[nodiscard]] static Answer solve(const offline::BlockMatrix& matrix, const TetrahedralMesh& mesh,
                                    const offline::FreeVertices& free, std::span<const offline::Double4> b,
                                    double tolerance);
};

}  // namespace greenloop::bench
