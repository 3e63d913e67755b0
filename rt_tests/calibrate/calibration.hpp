#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "rt_tests/calibrate/meter.hpp"
#include "rt_tests/stress/predicted_work.hpp"
#include "runtime/prices.hpp"

namespace greenloop {

struct CalibrationOptions {
  std::uint32_t contacts = 0;   ///< most of a step; 0: what each model asks for
  std::uint64_t cycles = 3000;  ///< steps of each model that prices are fitted to; as many again are predicted
  std::uint64_t seed = 1;
  std::function<void(const std::string& stage, double share)> progress = nullptr;
};

/// What a target charges, and how well that predicts steps that were not looked at for it.
struct Calibration {
  std::string unit;                            ///< what a work unit is
  Prices prices;                               ///< in it
  std::uint64_t fitted = 0;                    ///< steps that they were fitted to
  std::vector<std::uint64_t> paying;           ///< [price_count] those among them that each price is paid in
  RatioQuantiles all;                          ///< work over cost, of the other steps
  std::map<std::string, RatioQuantiles> ways;  ///< by ElastostaticDriver::way
};

/// Measures the prices of this machine, and how well they predict: the work that bodies with these prices report, over
/// what the meter says. Throws std::runtime_error naming the model that has too few steps, or none of a kind, and what
/// to do. Offline only.
[[nodiscard]] Calibration calibrate(const std::vector<NamedModel>& models, const CalibrationOptions& options,
                                    const Meter& meter);

/// The same of another machine, which ran record_script's steps with counting_prices on each model and counted: costs
/// in `unit`, above 0, of the steps of the first model, of the second, and so on. Every second hundred of them is not
/// fitted to, but predicted. Throws std::runtime_error as above, or if there are not as many costs as steps.
[[nodiscard]] Calibration calibrate(const std::vector<NamedModel>& models, const CalibrationOptions& options,
                                    const std::vector<double>& costs, const std::string& unit);

}  // namespace greenloop
