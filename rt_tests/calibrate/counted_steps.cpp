#include "rt_tests/calibrate/counted_steps.hpp"

#include <algorithm>
#include <cmath>

#include "rt_tests/harness/price_table.hpp"

namespace greenloop {
namespace {

constexpr auto row_count = static_cast<Eigen::Index>(price_count);

// [steps] work units
Eigen::VectorXd works(const std::vector<RanStep>& ran) {
  Eigen::VectorXd work(static_cast<Eigen::Index>(ran.size()));
  std::transform(ran.begin(), ran.end(), work.begin(),
                 [](const RanStep& step) { return static_cast<double>(step.work); });
  return work;
}

// those that were answered, whose work is that of their counts
CountedSteps kept_steps(const std::vector<RanStep>& ran, const Eigen::VectorXd& work, const Eigen::MatrixXd& counts,
                        const Prices& prices) {
  constexpr double rounding = 1e-4, of_a_term = 2;  // units: the work of a body at rest has two terms
  const Eigen::VectorXd of_counts = counts * in_units(prices);
  CountedSteps kept;
  for (std::size_t i = 0; i < ran.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    const double off = std::abs(of_counts[row] - work[row]);
    const bool right = off <= std::max(rounding * work[row], of_a_term) && counts.row(row).minCoeff() >= 0;
    if (!right || ran[i].way.empty()) continue;
    kept.step.push_back(i);
    kept.way.push_back(ran[i].way);
  }
  kept.counts = counts(kept.step, Eigen::all);
  return kept;
}

}  // namespace

Eigen::VectorXd in_units(const Prices& prices) {
  Eigen::VectorXd units(row_count);
  std::transform(std::begin(price_rows), std::end(price_rows), units.begin(),
                 [&](const PriceRow& row) { return prices.*row.member / 256.0; });
  return units;
}

CountedSteps count_steps(const Model& model, const ScriptOptions& options, const std::vector<BodySteps>& bodies,
                         const Progress& progress) {
  constexpr std::uint32_t raise = 256;  // a unit
  const Prices prices = counting_prices();
  const std::vector<RanStep> ran = run_steps(model, options, prices, bodies);
  const Eigen::VectorXd work = works(ran);
  Eigen::MatrixXd counts(work.size(), row_count);
  for (Eigen::Index j = 0; j < row_count; ++j) {
    progress(static_cast<double>(j) / static_cast<double>(row_count));
    Prices raised = prices;
    raised.*price_rows[j].member += raise;
    counts.col(j) = works(run_steps(model, options, raised, bodies)) - work;
  }
  return kept_steps(ran, work, counts, prices);
}

}  // namespace greenloop
