#pragma once

#include <span>
#include <vector>

#include "formats/mesh/tetrahedral_mesh.hpp"
#include "formats/store/material.hpp"
#include "offline/multigrid/block_matrix.hpp"
#include "offline/volume/free_vertices.hpp"

namespace greenloop::offline {

/// What each tetrahedron of a body is made of.
struct SolidMatter {
  struct Kind {
    Material material;
    double density = 0;  ///< kg/m^3
  };
  std::vector<Kind> kinds;
  std::vector<std::uint32_t> kind;  ///< of each tetrahedron

  [[nodiscard]] std::vector<double> young() const;  ///< Pa, of each tetrahedron
};

/// stiffness K + mass M over the free vertices, K in N/m of linear tetrahedra, M their consistent mass in kg; N/m where
/// `mass` is in 1/s^2. Linear work, deterministic. Throws std::invalid_argument on a tetrahedron without positive
/// volume, a material or density out of range and sizes that do not fit.
[[nodiscard]] BlockMatrix assemble_blocks(const TetrahedralMesh& mesh, const SolidMatter& matter,
                                          const FreeVertices& free, double stiffness, double mass);

}  // namespace greenloop::offline
