#pragma once

#include <nlohmann/json.hpp>

#include "rt_tests/calibrate/calibration.hpp"

namespace greenloop {

/// What greenloop-calibrate says with --json: prices, fitted steps, and ratios by way.
[[nodiscard]] nlohmann::json as_json(const Calibration& calibration);

/// The same for people, on standard output.
void print(const Calibration& calibration);

}  // namespace greenloop
