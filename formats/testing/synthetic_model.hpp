#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "formats/write/writer.hpp"

namespace greenloop {

/// A small body for tests: an octahedron split onto a sphere of radius 0.1 m, held below z = -0.05 m.
struct SyntheticOptions {
  std::uint32_t components = 3;                 ///< 3: elastostatic; 1: scalar
  std::uint32_t levels = 3;                     ///< 1..6 mesh levels: 6, 18, 66, 258, 1026, 4098 nodes
  std::uint32_t coarsest_constraint_level = 0;  ///< < levels
  layout::Wavelet wavelet = layout::Wavelet::lifted_linear;
  double epsilon = 0.005;       ///< scaled blocks of smaller norm over root 3 are dropped; 0 keeps all
  double quantum = 0.002;       ///< of the 8-bit layer; that of 4 bits differs
  double touchable_above = 0;   ///< nodes with z >= this times the radius may be contacts; at most 1
  double read_above = -1;       ///< domain nodes with z >= this times the radius are read
  std::uint32_t vertices = 0;   ///< of a vertex map; 0: there is none
  bool gravity = false;         ///< accelerations among the loads; each node has a mass of 100 kg/m^2 times its area
  std::uint32_t pressures = 0;  ///< more loads, "pressure 0" and so on: number k inwards where x_(k mod 3) >= 0
};

/// The exact compliance of that body between points x and y (m): 1e-3 m/N exp(-|x - y| / 0.05 m) Q(x) C Q(y)^T with a
/// constant C and a smoothly varying Q. Symmetric positive definite over any points, not elastic; its blocks are not
/// symmetric.
[[nodiscard]] Eigen::Matrix3d synthetic_compliance(const Eigen::Vector3d& x, const Eigen::Vector3d& y);

/// The same of the scalar model: 1e-3 exp(-|x - y| / 0.05 m), of a unit a unit load.
[[nodiscard]] double synthetic_scalar_compliance(const Eigen::Vector3d& x, const Eigen::Vector3d& y);

/// A valid model of that body: scaled, thresholded, quantised; the compliance it stands for is positive definite too.
/// The errors in Level are measured, but patch_force_error and Info::lambda_min stay 0. On the finest of several levels
/// the free nodes below z = -0.02 m are outside the domain; Butterfly wavelets predict linearly below z = -0.03 m, the
/// weights of Equilibrated ones are arbitrary. A node is represented by the nearest touchable node. Work and memory:
/// quadratic in the nodes. Offline only, for tests and fuzzing.
[[nodiscard]] ModelData synthetic_model(const SyntheticOptions& options);

/// Some valid records of patterns, by kind and contacts, all numbers different.
[[nodiscard]] std::vector<layout::PatternRecord> synthetic_patterns();

}  // namespace greenloop
