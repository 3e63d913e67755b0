#pragma once

#include <string>
#include <vector>

#include "offline/report/figure.hpp"
#include "offline/report/trace.hpp"

namespace greenloop::offline {

/// The force over time: of every probe when several push, else its components. `trace` has at least one cycle, here and
/// below; the figures' size does not grow with its length. run: its name if there are several, or empty.
[[nodiscard]] Figure force_figure(const std::vector<TraceCycle>& trace, const std::string& run = {});

/// The work of every cycle against its budget, misses crossed.
[[nodiscard]] Figure work_figure(const std::vector<TraceCycle>& trace);

/// Constraint and field level over time, and how often each constraint level answered; `levels` of the model.
[[nodiscard]] Figure levels_figure(const std::vector<TraceCycle>& trace, std::size_t levels);

}  // namespace greenloop::offline
