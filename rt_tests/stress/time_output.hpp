#pragma once

#include <nlohmann/json.hpp>

#include "sim_hw/guard/time_histogram.hpp"

namespace greenloop {

/// {unit, clock, count[], overflows, total, min, avg, max}
[[nodiscard]] nlohmann::json as_json(const TimeHistogram& times);

/// To standard output, as cyclictest prints it; empty bins are left out.
void print_histogram(const TimeHistogram& times);

}  // namespace greenloop
