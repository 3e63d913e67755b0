#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace greenloop::offline {

/// What a compression comes to at one threshold.
struct RatePoint {
  double threshold = 0;
  double ratio = 0;         ///< blocks of the dense matrix over blocks kept
  double bytes = 0;         ///< of the model file, cut off after the level; 0: there is none
  double rms = 0;           ///< James & Pai 2003, equation 70
  double worst_column = 0;  ///< the same, equation 71
  double patch_force = 0;   ///< ContactPatches::worst_force_error; infinite if a patch is not positive definite
};

/// One constraint level's points, by increasing threshold.
struct LevelRates {
  std::size_t level = 0, columns = 0;
  std::vector<RatePoint> points;
};

using RateQuantity = double RatePoint::*;

/// `wanted` where `given` passes through `value`, by interpolation on logarithmic scales between the first two
/// neighbouring points that enclose it; empty if none do. Points that are not positive and finite are passed over.
[[nodiscard]] std::optional<double> interpolate(const std::vector<RatePoint>& points, RateQuantity given, double value,
                                                RateQuantity wanted);

/// y = intercept + slope x by least squares.
struct LineFit {
  double intercept = 0, slope = 0;
  double r_squared = 0;  ///< share of the variance of y that the line explains
};

/// At least two different x; as many y. Throws std::invalid_argument otherwise.
[[nodiscard]] LineFit fit_line(const std::vector<double>& x, const std::vector<double>& y);

}  // namespace greenloop::offline
