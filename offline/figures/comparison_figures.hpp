#pragma once

#include <vector>

#include "offline/figures/comparison.hpp"
#include "offline/report/figure.hpp"

namespace greenloop::offline {

/// The finest level's errors over compression, both forms, every wavelet: Figure 14 of James & Pai 2003 and the forces.
[[nodiscard]] Figure error_over_ratio(const BodyComparison& body);

/// The same errors over the threshold: Figure 15.
[[nodiscard]] Figure error_over_threshold(const BodyComparison& body);

/// RMS error over compression and over the threshold, constraint level by constraint level, with the last wavelet:
/// Figures 18 to 21.
[[nodiscard]] Figure level_errors_over_ratio(const BodyComparison& body);

/// A step's work and processor time over the blocks kept, with the fitted lines: Figure 17.
[[nodiscard]] Figure summation_cost(const BodyComparison& body);

/// How much more each body compresses than the next smaller one, over the RMS error: Figure 16. At least two bodies.
[[nodiscard]] Figure growth_figure(const std::vector<BodyComparison>& bodies);

}  // namespace greenloop::offline
