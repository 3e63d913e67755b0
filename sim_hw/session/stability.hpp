#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "sim_hw/session/session.hpp"

namespace greenloop {

/// A loop of one rate, delay and stiffness, with a hand that presses a ball into the body and is disturbed.
struct StabilityCell {
  double rate = 0;       ///< Hz
  double delay = 0;      ///< s, from a position to its force, beyond the hold
  double stiffness = 0;  ///< N/m, of the body as the handle feels it where it is pressed, along the push
  double bound = 0;      ///< N/m, up to which the loop is passive against any hand (Colgate & Schenkel 1997)
  double early = 0;      ///< m, swing of the handle in the second quarter of the time
  double late = 0;       ///< m, in the last
  double largest = 0;    ///< m, in any quarter

  /// The swing dies away, or is within what the encoders see, and never throws the handle far off.
  [[nodiscard]] bool stable() const;
};

/// Three rates, five delays, and `steps` (2 or more) stiffnesses for each, from a quarter of the bound to eight times
/// it. Of `options` count the model, friction, budget, starve, passive and hand. Work: 15 * steps loops of a second.
/// Throws as run_session does.
[[nodiscard]] std::vector<StabilityCell> stability_map(const SessionOptions& options, std::size_t steps);

/// One line per cell: rate, delay, stiffness, bound, early, late, largest, stable. Throws std::runtime_error if the
/// file cannot be written.
void write_stability(const std::filesystem::path& file, const std::vector<StabilityCell>& cells);

}  // namespace greenloop
