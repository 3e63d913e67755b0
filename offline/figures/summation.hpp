#pragma once

#include <cstddef>
#include <vector>

#include "formats/write/writer.hpp"
#include "offline/figures/rate_curve.hpp"

namespace greenloop::offline {

/// A step's cost on one model.
struct SummationPoint {
  double blocks = 0;   ///< that the field of a step sums, mean over the contact sets
  double work = 0;     ///< units, mean over the contact sets
  double seconds = 0;  ///< of the thread's processor time, median of the rounds
};

/// Contact sets of `contacts` nodes spread over the body, held with cached factors, the field of every node summed:
/// what James & Pai 2003 time in Figure 17. Throws std::runtime_error if the model is refused.
[[nodiscard]] SummationPoint time_summation(const ModelData& model, std::size_t contacts, std::size_t rounds);

/// Cost against blocks.
struct SummationFit {
  LineFit work, seconds;
};
[[nodiscard]] SummationFit fit_summation(const std::vector<SummationPoint>& points);

}  // namespace greenloop::offline
