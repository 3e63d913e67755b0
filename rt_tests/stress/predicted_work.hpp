#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "rt_tests/harness/driver.hpp"
#include "rt_tests/stress/stress_run.hpp"
#include "runtime/model.hpp"

namespace greenloop {

/// Quantiles of some ratios.
struct RatioQuantiles {
  std::uint64_t steps = 0;
  double least = 0, p05 = 0, median = 0, p95 = 0, most = 0;  ///< 0 without steps
};

[[nodiscard]] RatioQuantiles quantiles(std::vector<double> ratios);

/// Work that steps reported, over the instructions that they took.
struct PredictedWork {
  RatioQuantiles all;
  std::map<std::string, RatioQuantiles> ways;  ///< by D::way
};

/// Runs the scripts of `options` again and counts the instructions of `steps` steps of each, spread evenly over its
/// cycles; those that are refused are left out. Counted by trapping after each instruction (sim_hw/guard/
/// instruction_counter), microseconds an instruction. No steps where that cannot be done.
template <Driver D>
[[nodiscard]] PredictedWork compare_work(const Model& model, const StressOptions& options, std::uint64_t steps);

}  // namespace greenloop
