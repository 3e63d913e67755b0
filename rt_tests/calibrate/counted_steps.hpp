#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "rt_tests/calibrate/meter.hpp"

namespace greenloop {

/// [price_count] work units, in the order of price_rows.
[[nodiscard]] Eigen::VectorXd in_units(const Prices& prices);

/// Steps with the counts that their work is made of, those that were answered.
struct CountedSteps {
  std::vector<std::size_t> step;  ///< [kept] places among the steps that were run, increasing
  std::vector<std::string> way;   ///< [kept] as ElastostaticDriver has it
  Eigen::MatrixXd counts;         ///< [kept x price_count], in the order of price_rows
};

/// Counts by running the steps once more with each price a little higher: by how much more the work is. Steps whose
/// counts times prices are not their work, since something else was done for the new price, are left out.
/// progress: called with the share that is done, 0..1. bodies: record_steps with counting_prices.
[[nodiscard]] CountedSteps count_steps(const Model& model, const ScriptOptions& options,
                                       const std::vector<BodySteps>& bodies, const Progress& progress);

}  // namespace greenloop
