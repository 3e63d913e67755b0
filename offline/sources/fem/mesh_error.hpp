#pragma once

#include <functional>
#include <span>
#include <vector>

#include "offline/sources/fem/fem_source.hpp"

namespace greenloop::offline {

/// A patch of vertices of the volume's boundary, displaced as a whole along an axis.
struct PressedPatch {
  Eigen::Vector3d center;  ///< m
  int axis = 0;
  double own_force = 0;        ///< N per m of displacement, with the elements of the problem
  double linear_force = 0;     ///< with linear elements
  double quadratic_force = 0;  ///< with quadratic ones on the same tetrahedra
  double limit_force = 0;      ///< what finer ones would go towards (held_forces)

  /// By how much the elements of the problem are too stiff.
  [[nodiscard]] double error() const { return own_force / limit_force - 1; }
};

/// What the mesh itself costs, which no compression can show: it compares with the same mesh.
struct MeshError {
  std::vector<PressedPatch> patches;  ///< the worst ones that were solved again, the worst first
  bool settled = true;                ///< whether every solution had converged; if not, errors are larger than said

  [[nodiscard]] double force() const { return patches.empty() ? 0 : patches.front().error(); }
};

/// How the search goes on: 0..1.
using MeshErrorProgress = std::function<void(double fraction)>;

/// Presses patches of up to 64 neighbouring vertices that the touched nodes of the surface hang on, spread over the
/// surface, along each axis with linear elements, ranks them by the energy that quadratic displacements along single
/// edges would release (Bank & Smith 1993), and solves the worst of different places again with quadratic elements,
/// then with those of tetrahedra around them that are split once (held_body.hpp). Deterministic. Throws what FemSource
/// does. Work: four factorisations, 3 x 64 right-hand sides a patch, some hundred element sweeps for each of the worst.
[[nodiscard]] MeshError estimate_mesh_error(const FemProblem& problem, std::span<const int> touched,
                                            const MeshErrorProgress& progress = {});

}  // namespace greenloop::offline
