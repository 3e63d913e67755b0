#pragma once

#include <vector>

#include "offline/compress/wavelet/wavelet_compliance.hpp"

namespace greenloop::offline {

/// Conditional compliance of every coefficient [m/N] given those it is coupled to most, on all levels, at most 64 of
/// them. `diagonal`: the coefficients' own blocks; `couplings`: by level of the column, not scaled. N is 1 or 3. Throws
/// std::invalid_argument if a diagonal block is not positive definite. Work: a factorisation of 65 N rows per
/// coefficient.
template <unsigned N>
[[nodiscard]] std::vector<SquareMatrix<N>> conditional_compliance(const std::vector<SquareMatrix<N>>& diagonal,
                                                                  const std::vector<CouplingCandidates<N>>& couplings);

}  // namespace greenloop::offline
