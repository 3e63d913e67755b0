#pragma once

#include <functional>
#include <string>
#include <vector>

#include "rt_tests/calibrate/recorded_steps.hpp"

namespace greenloop {

/// A model to calibrate with, by the name of its file.
struct NamedModel {
  std::string name;
  Model model;
};

/// Called with the share that is done, 0..1.
using Progress = std::function<void(double)>;

/// How it is measured what steps cost.
struct Meter {
  std::string unit;        ///< of a cost, and of work with prices that are fitted to costs
  double least = 0;        ///< cost of a step that can be told
  bool disturbed = false;  ///< by what else the machine does
  /// Of each step of the bodies, in order, which are of the model with these prices.
  std::function<std::vector<double>(const NamedModel& model, const ScriptOptions& options, const Prices& prices,
                                    const std::vector<BodySteps>& bodies, const Progress& progress)>
      costs = nullptr;
};

/// Least nanoseconds by the stopwatch over so many runs; all of them do the same.
[[nodiscard]] Meter time_meter(int repetitions, const Stopwatch& stopwatch);

/// Instructions, by Valgrind, of a program that runs record_steps' steps on a model once: PROGRAM MODEL --run-steps
/// --contacts K --cycles N --seed S --prices FILE. Its costs throw std::runtime_error if that does not end well.
[[nodiscard]] Meter instruction_meter(const std::string& program);

}  // namespace greenloop
