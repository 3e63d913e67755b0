#pragma once

#include <filesystem>
#include <vector>

#include "offline/report/figure.hpp"

namespace greenloop::offline {

/// A loop of greenloop-loop --stability.
struct StabilityPoint {
  double rate = 0;       ///< Hz
  double delay = 0;      ///< s
  double stiffness = 0;  ///< N/m
  double bound = 0;      ///< N/m, up to which it is passive against any hand
  bool stable = false;   ///< in the simulation
};

/// Reads rate, delay, stiffness, bound, stable; others are left alone. Throws std::runtime_error with file, line,
/// column and value if a column is missing or a cell does not parse, if there is no line, or where rate, stiffness or
/// bound is not above zero.
[[nodiscard]] std::vector<StabilityPoint> load_stability(const std::filesystem::path& path);

/// Stiffness over delay, a panel for each rate: which loops came to rest, and the analytic bound. At least one point.
[[nodiscard]] Figure stability_figure(const std::vector<StabilityPoint>& points);

}  // namespace greenloop::offline
