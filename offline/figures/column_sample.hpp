#pragma once

#include <cstddef>
#include <vector>

#include "offline/compress/wavelet/surface_wavelet.hpp"
#include "offline/figures/column_compression.hpp"
#include "offline/figures/rate_curve.hpp"

namespace greenloop::offline {

/// Rows of one mesh level, of which some are measured.
struct Stratum {
  std::size_t size = 0;           ///< rows of the level
  std::vector<std::size_t> rows;  ///< those measured
};

/// About `count` rows, by mesh level in proportion to the levels' sizes but at least 16 of each, or all of them. Those
/// of a level are the first of a van der Corput sequence along it, in its order: spread along the level's Morton curve,
/// and a larger sample begins with a smaller one.
[[nodiscard]] std::vector<Stratum> stratified_sample(const SurfaceWavelet& wavelet, std::size_t count);

/// All rows of a sample in an order whose first part has about the same share of every level: a run that ends early has
/// measured a smaller sample.
[[nodiscard]] std::vector<std::size_t> interleaved(const std::vector<Stratum>& strata);

/// A figure of all columns estimated from a sample.
struct SampledRate {
  RatePoint point;         ///< worst_column: the worst measured
  double ratio_error = 0;  ///< standard error of the ratio, relative to it
  double rms_error = 0;    ///< standard error of the RMS error, relative to it
};

/// The one-sided form at every threshold from the columns of a sample (`columns[stratum][i]` is that of
/// `strata[stratum].rows[i]`), by stratified random sampling (Cochran 1977, sections 5.4 and 6.11): spread samples are
/// closer than the standard errors say. A sample of everything has none.
[[nodiscard]] std::vector<SampledRate> estimate_rates(const std::vector<Stratum>& strata,
                                                      const std::vector<std::vector<CompressedColumn>>& columns,
                                                      const std::vector<double>& thresholds);

}  // namespace greenloop::offline
