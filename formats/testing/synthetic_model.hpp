#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "formats/writer.hpp"

namespace greenloop {

/// A small body for tests: an octahedron split onto a sphere of radius 0.1 m, held below z = -0.05 m.
struct SyntheticOptions {
  std::uint32_t levels = 3;                     ///< 1..6 mesh levels: 6, 18, 66, 258, 1026, 4098 nodes
  std::uint32_t coarsest_constraint_level = 0;  ///< < levels
  bool lifted = true;                           ///< else the plain Linear wavelet
  double field = 0.01;                          ///< scaled blocks of this norm over root 3 make fields
  double epsilon = 0.005;                       ///< below this they are dropped; 0 keeps all
  double quantum = 0.002;                       ///< of the field's 8-bit layer; those of 4 bits and of forces differ
  double touchable_above = 0;                   ///< nodes with z >= this times the radius may be contacts; at most 1
};

/// The exact compliance of that body between points x and y (m): 1e-3 m/N exp(-|x - y| / 0.05 m) Q(x) C Q(y)^T with a
/// constant C and a smoothly varying Q. Symmetric positive definite over any points, not elastic; its blocks are not
/// symmetric.
[[nodiscard]] Eigen::Matrix3d synthetic_compliance(const Eigen::Vector3d& x, const Eigen::Vector3d& y);

/// A valid model of that body: scaled, thresholded, quantised; the compliance it stands for is positive definite too.
/// The errors in Level are measured, but patch_force_error and Info::lambda_min stay 0. On the finest of several levels
/// the free nodes below z = -0.02 m are outside the domain. A node is represented by the nearest touchable node.
/// Work and memory: quadratic in the nodes. Offline only, for tests and fuzzing.
[[nodiscard]] ModelData synthetic_model(const SyntheticOptions& options);

}  // namespace greenloop
