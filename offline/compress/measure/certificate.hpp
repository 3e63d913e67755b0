#pragma once

#include <cstddef>

#include "offline/compress/encode/compressed_compliance.hpp"
#include "offline/progress.hpp"

namespace greenloop::offline {

/// An estimate, from above, of the least eigenvalue of U^ on its finest level [m/N], by the Lanczos method with full
/// reorthogonalisation from a fixed start. Negative or zero if an indefinite direction was found. Work: some hundred
/// applications of U^; memory: as many vectors. Deterministic. Offline only.
[[nodiscard]] double estimate_least_eigenvalue(const CompressedCompliance<3>& compressed, const Progress& progress);

struct CertificateCheck {
  bool holds = false;
  std::size_t unknowns = 0;
  double shift = 0;  ///< m/N: U^ - shift I was factored, lambda_min and a bound of the rounding errors together
};

/// Bytes that check_certificate needs.
[[nodiscard]] std::size_t certificate_check_bytes(const CompressedCompliance<3>& compressed);

/// Proves that every eigenvalue of U^ on its finest level is above `lambda_min` (m/N, positive): the Cholesky
/// factorisation of U^ - shift I, in double precision, must not break down (Rump 2006: its rounding errors are below
/// (n + 1) eps trace). Then U_SS is positive definite for every contact set S; and so is the compliance of every
/// coarser constraint level, being a principal block of a matrix congruent to U^, and that of any mixture of levels.
/// Work: n^3 / 3 for n = 3 per domain node. Offline only.
[[nodiscard]] CertificateCheck check_certificate(const CompressedCompliance<3>& compressed, double lambda_min,
                                                 const Progress& progress);

}  // namespace greenloop::offline
