#pragma once

#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "rt_tests/harness/driver.hpp"
#include "rt_tests/stress/stress_run.hpp"
#include "runtime/model.hpp"

namespace greenloop {

/// What a step said of itself.
struct ReportedStep {
  std::string way;  ///< D::way; empty: refused
  std::uint64_t work = 0;
};

/// Runs the scripts of `options` without guards, and at last the heaviest kind of step: a fresh body, all contacts
/// spread over what can be touched, no limit of work, the field of all nodes.
template <Driver D>
[[nodiscard]] std::vector<ReportedStep> run_plainly(const Model& model, const StressOptions& options);

/// As lines of work and way.
void write_steps(const std::vector<ReportedStep>& steps, std::ostream& out);
[[nodiscard]] std::vector<ReportedStep> read_steps(std::istream& in);

/// Instructions of every call of a solver's step that a program makes, in order, counted by Valgrind (callgrind),
/// which is run as a program of its own. solver: its class; out: what the program printed. Throws std::runtime_error if
/// it cannot be run or does not end well.
[[nodiscard]] std::vector<std::uint64_t> count_step_instructions(const std::string& solver,
                                                                 const std::vector<std::string>& command,
                                                                 std::string& out);

/// Quantiles of some ratios.
struct RatioQuantiles {
  std::uint64_t steps = 0;
  double least = 0, p05 = 0, median = 0, p95 = 0, most = 0;  ///< 0 without steps
  double within = 0;                                         ///< the share that is 0.8..1.25
};

[[nodiscard]] RatioQuantiles quantiles(std::vector<double> ratios);

[[nodiscard]] nlohmann::json as_json(const RatioQuantiles& ratios);

/// As a table on standard output, of each way of answering and of all.
void print_ratios(const std::map<std::string, RatioQuantiles>& ways, const RatioQuantiles& all);

/// Work that steps reported, over the instructions that they took.
struct PredictedWork {
  RatioQuantiles all;                          ///< of answered steps
  std::map<std::string, RatioQuantiles> ways;  ///< by D::way
  std::uint64_t heaviest_instructions = 0;     ///< of the heaviest kind of step
};

[[nodiscard]] nlohmann::json as_json(const PredictedWork& predicted);

/// Of the steps of run_plainly. Throws std::invalid_argument if there are not as many of both.
[[nodiscard]] PredictedWork compare(const std::vector<ReportedStep>& steps,
                                    const std::vector<std::uint64_t>& instructions);

}  // namespace greenloop
