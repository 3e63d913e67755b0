#pragma once

#include <Eigen/Core>

namespace greenloop::offline {

/// The sign (-1, 0, +1) of det[b - a, c - a]: positive if a, b, c turn counter-clockwise. Exact for finite coordinates
/// whose products neither overflow nor underflow: a floating-point filter, then expansions without rounding
/// (Shewchuk, "Adaptive precision floating-point arithmetic and fast robust geometric predicates", 1997, section 2).
[[nodiscard]] int orientation(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c);

/// The sign (-1, 0, +1) of det[b - a, c - a, d - a]: positive if a, b, c look clockwise from d, which is the sign of a
/// tetrahedron's volume in formats/mesh. Exact in the same sense.
[[nodiscard]] int orientation(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                              const Eigen::Vector3d& d);

}  // namespace greenloop::offline
