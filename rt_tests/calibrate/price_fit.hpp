#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "runtime/prices.hpp"

namespace greenloop {

/// Steps that prices are fitted to.
struct FitSteps {
  Eigen::MatrixXd counts;          ///< [steps x price_count], in the order of price_rows
  Eigen::VectorXd cost;            ///< [steps] of each, above 0
  std::vector<std::string> group;  ///< [steps] each group weighs the same, unless it is small
  bool disturbed = true;           ///< some costs may be far too high
};

/// Prices whose products with the counts are nearest to the costs: least squares of the relative errors;
/// of costs that may be disturbed reweighted so that errors above 5 % count by themselves, not by their squares. None
/// is below a tenth of the default price, in the cost of a default unit, and where the steps do not tell, they stand in
/// the ratio of the default ones. Throws std::invalid_argument without steps. Offline only.
[[nodiscard]] Prices fit_prices(const FitSteps& steps);

}  // namespace greenloop
