#pragma once

#include <Eigen/Core>
#include <vector>

#include "offline/compress/compliance_pyramid.hpp"

namespace greenloop::offline {

/// Conditional compliance of every coefficient of a level given those it is coupled to most, at most 24 of them [m/N].
/// `diagonal`: the coefficients' own blocks; `couplings`: with each other, scaled by the roots of those blocks.
/// Work: a 75 x 75 factorisation per coefficient.
[[nodiscard]] std::vector<Eigen::Matrix3d> conditional_compliance(const std::vector<Eigen::Matrix3d>& diagonal,
                                                                  const CouplingCandidates& couplings);

/// The same given all others. Throws std::invalid_argument if the compliance is not positive definite. Work: one dense
/// inverse.
[[nodiscard]] std::vector<Eigen::Matrix3d> conditional_compliance(const DenseCompliance& compliance);

}  // namespace greenloop::offline
