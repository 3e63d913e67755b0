#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

#include "formats/mesh/tetrahedral_mesh.hpp"
#include "formats/store/material.hpp"
#include "offline/volume/free_vertices.hpp"

namespace greenloop::offline {

/// Throws std::invalid_argument naming the value out of range.
void require_valid(const Material& material);

/// Lame's constants, Pa.
struct Lame {
  double lambda, mu;

  /// Throws std::invalid_argument naming the value out of range.
  explicit Lame(const Material& material);
};

/// Stiffness of one linear tetrahedron, N/m; degree of freedom 3a + i is vertex a's displacement along axis i.
/// `corners` holds the four vertices as columns, m, positively oriented.
[[nodiscard]] Eigen::Matrix<double, 12, 12> element_stiffness(const Eigen::Matrix<double, 3, 4>& corners,
                                                              const Material& material);

/// Stiffness matrix over the free vertices, N/m: lower triangle only, 3 count x 3 count, fixed vertices eliminated.
/// Linear work, deterministic. Throws std::invalid_argument on a tetrahedron without positive volume.
[[nodiscard]] Eigen::SparseMatrix<double> assemble_stiffness(const TetrahedralMesh& mesh, const Material& material,
                                                             const FreeVertices& free);

}  // namespace greenloop::offline
