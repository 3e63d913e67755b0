#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "rt_tests/calibrate/recorded_steps.hpp"
#include "rt_tests/stress/predicted_work.hpp"
#include "runtime/prices.hpp"

namespace greenloop {

/// A model to calibrate with, by the name that errors have.
struct NamedModel {
  std::string name;
  Model model;
};

struct CalibrationOptions {
  std::uint32_t contacts = 0;   ///< most of a step; 0: what each model asks for
  std::uint64_t cycles = 2000;  ///< steps of each model that prices are fitted to; as many again are predicted
  std::uint64_t seed = 1;
  int repetitions = 7;  ///< of every step; the least time counts
  std::function<void(const std::string& stage, double share)> progress = nullptr;
};

/// What a target charges, and how well that predicts steps that were not looked at for it.
struct Calibration {
  Prices prices;                               ///< a work unit is a nanosecond
  std::uint64_t fitted = 0;                    ///< steps that they were fitted to
  std::vector<std::uint64_t> paying;           ///< [price_count] those among them that each price is paid in
  RatioQuantiles all;                          ///< work in units over nanoseconds, of the other steps
  std::map<std::string, RatioQuantiles> ways;  ///< by ElastostaticDriver::way
};

/// Measures the prices of this machine, and how well they predict: the work that bodies with these prices report, over
/// the time that they take. Throws std::runtime_error naming the model that has too few steps, or none of a kind, and
/// what to do. Offline only.
[[nodiscard]] Calibration calibrate(const std::vector<NamedModel>& models, const CalibrationOptions& options,
                                    const Stopwatch& stopwatch);

}  // namespace greenloop
