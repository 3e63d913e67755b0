#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "formats/mesh/tetrahedral_mesh.hpp"
#include "formats/write/multigrid.hpp"
#include "offline/sources/fem/block_matrices.hpp"

namespace greenloop::offline {

/// An elastic body that the loop is to simulate.
struct MultigridScene {
  TetrahedralMesh mesh;                  ///< m
  std::vector<std::uint8_t> fixed;       ///< per vertex, nonzero = held for good
  SolidMatter matter;                    ///< with densities above 0
  std::vector<TetrahedralMesh> coarser;  ///< from the second finest grid to the coarsest; none: one grid
  layout::Strain strain = layout::Strain::corotational;
  double time_step = 0;                     ///< s
  double mass_damping = 0;                  ///< 1/s
  double stiffness_damping = 0;             ///< s
  double numerical_damping = 0;             ///< 0..1
  Eigen::Vector3d gravity = {0, 0, -9.81};  ///< m/s^2
  std::vector<Eigen::Vector3d> shown;       ///< m, vertices of the surface that is shown, at rest
  std::vector<std::uint32_t> triangles;     ///< [triangles][3]
};

/// The model: free vertices in the mesh's order, held ones behind; operators of the body at rest on every grid; shown
/// vertices hang on the tetrahedron around them, or on the nearest. Throws std::invalid_argument as assemble_blocks,
/// prolongations and galerkin do, and where the coarsest grid has too many vertices for a model. Work: linear, and the
/// cube of the coarsest grid.
[[nodiscard]] MultigridData multigrid_model(const MultigridScene& scene);

}  // namespace greenloop::offline
