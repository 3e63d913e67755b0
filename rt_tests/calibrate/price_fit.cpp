#include "rt_tests/calibrate/price_fit.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include "rt_tests/calibrate/bounded_least_squares.hpp"
#include "rt_tests/calibrate/counted_steps.hpp"
#include "rt_tests/harness/price_table.hpp"

namespace greenloop {
namespace {

// [steps] whose sum is 1
Eigen::VectorXd weights(const std::vector<std::string>& group) {
  constexpr int small = 20;  // steps: their errors are taken for chance
  std::map<std::string, int> steps;
  for (const std::string& name : group) ++steps[name];
  Eigen::VectorXd weight(static_cast<Eigen::Index>(group.size()));
  std::transform(group.begin(), group.end(), weight.begin(),
                 [&](const std::string& name) { return 1.0 / std::max(steps.at(name), small); });
  return weight / weight.sum();
}

double median(Eigen::VectorXd values) {
  const auto middle = values.begin() + values.size() / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// [price_count] prices, each of which would make about the costs that are measured alone; 1 where nothing is counted
Eigen::VectorXd plain_scale(const Eigen::MatrixXd& relative, const Eigen::VectorXd& weight) {
  const Eigen::VectorXd square = relative.cwiseAbs2().transpose() * weight;
  return (square.array() > 0).select(square.cwiseSqrt().cwiseInverse(), 1.0);
}

Prices in_256ths(const Eigen::VectorXd& units, const Eigen::VectorXd& least) {
  Prices prices;
  for (std::size_t j = 0; j < price_count; ++j) {
    const auto row = static_cast<Eigen::Index>(j);
    const auto price = static_cast<std::uint32_t>(std::lround(256 * units[row]));
    prices.*price_rows[j].member = std::max<std::uint32_t>(price, least[row] > 0 ? 1 : 0);
  }
  return prices;
}

}  // namespace

Prices fit_prices(const FitSteps& steps) {
  constexpr double pull = 1e-5;  // towards the default prices, of the mean square error
  constexpr double least = 0.1;  // of the default prices
  const int rounds = steps.disturbed ? 5 : 1;
  constexpr double usual_error = 0.05;  // beyond which steps weigh less, so that a few disturbed ones do not matter
  if (steps.cost.size() == 0) throw std::invalid_argument("fit_prices: no steps");
  const Eigen::VectorXd usual = in_units({});
  const Eigen::VectorXd expected = (usual.array() > 0).cast<double>();
  const Eigen::VectorXd weight = weights(steps.group);
  const Eigen::MatrixXd relative = steps.cost.cwiseInverse().asDiagonal() * steps.counts;
  const double cost_per_unit = median((relative * usual).cwiseInverse());
  const Eigen::VectorXd scale = (expected.array() > 0).select(cost_per_unit * usual, plain_scale(relative, weight));
  const Eigen::MatrixXd shares = relative * scale.asDiagonal();
  const Eigen::MatrixXd ridge = pull * Eigen::MatrixXd::Identity(scale.size(), scale.size());
  Eigen::VectorXd x, typical = weight;
  for (int round = 0; round < rounds; ++round) {
    const Eigen::MatrixXd weighted = shares.transpose() * typical.asDiagonal();
    x = bounded_least_squares(weighted * shares + ridge, weighted.rowwise().sum() + pull * expected, least * expected);
    typical = weight.array() / ((shares * x).array() - 1).abs().max(usual_error);
    typical /= typical.sum();
  }
  return in_256ths(scale.cwiseProduct(x), expected);
}

}  // namespace greenloop
