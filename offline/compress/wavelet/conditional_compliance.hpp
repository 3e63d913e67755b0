#pragma once

#include <Eigen/Core>
#include <vector>

#include "offline/compress/wavelet/wavelet_compliance.hpp"

namespace greenloop::offline {

/// Conditional compliance of every coefficient [m/N] given those it is coupled to most, on all levels, at most 64 of
/// them. `diagonal`: the coefficients' own blocks; `couplings`: by level of the column, not scaled. Throws
/// std::invalid_argument if a diagonal block is not positive definite. Work: a 195 x 195 factorisation per coefficient.
[[nodiscard]] std::vector<Eigen::Matrix3d> conditional_compliance(const std::vector<Eigen::Matrix3d>& diagonal,
                                                                  const std::vector<CouplingCandidates>& couplings);

}  // namespace greenloop::offline
