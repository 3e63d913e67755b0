#pragma once

#include <Eigen/Core>

namespace greenloop::offline {

/// Integrals over a triangle (corners as columns, m) of max(0, 1 - |x - centre| / radius) times each corner's linear
/// function, m^2: what a force that a mask spreads (James & Pai 2001, section 6.1) puts on its vertices. By the middles
/// of parts of the triangle, of an edge of at most half the radius where 64 parts are enough.
[[nodiscard]] Eigen::Vector3d mask_integrals(const Eigen::Matrix3d& corners, const Eigen::Vector3d& centre,
                                             double radius);

}  // namespace greenloop::offline
