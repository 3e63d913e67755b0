#include "rt_tests/calibrate/counted_steps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

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
  constexpr double rounding = 1e-4;
  const Eigen::VectorXd of_counts = counts * in_units(prices);
  CountedSteps kept;
  for (std::size_t i = 0; i < ran.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    const bool right = std::abs(of_counts[row] - work[row]) <= rounding * work[row] && counts.row(row).minCoeff() >= 0;
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

Prices counting_prices() {
  constexpr std::uint32_t room = 64;  // some prices are sums of products of others with small numbers
  Prices prices;
  std::uint32_t dearest = 1;
  for (const PriceRow& row : price_rows) dearest = std::max(dearest, prices.*row.member);
  std::uint32_t factor = 1;
  while (dearest <= std::numeric_limits<std::uint32_t>::max() / room / (2 * factor)) factor *= 2;
  for (const PriceRow& row : price_rows) prices.*row.member *= factor;
  return prices;
}

CountedSteps count_steps(const Model& model, const ScriptOptions& options, const std::vector<BodySteps>& bodies,
                         const std::function<void(double)>& progress) {
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

std::vector<double> least_times(const Model& model, const ScriptOptions& options, const Prices& prices,
                                const std::vector<BodySteps>& bodies, int repetitions, const Stopwatch& stopwatch,
                                const std::function<void(double)>& progress) {
  std::vector<double> least;
  for (int repetition = 0; repetition < repetitions; ++repetition) {
    progress(static_cast<double>(repetition) / repetitions);
    const std::vector<RanStep> ran = run_steps(model, options, prices, bodies, stopwatch);
    least.resize(ran.size(), std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < ran.size(); ++i) least[i] = std::min(least[i], ran[i].ns);
  }
  return least;
}

}  // namespace greenloop
