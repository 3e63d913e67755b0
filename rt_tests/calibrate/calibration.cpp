#include "rt_tests/calibrate/calibration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "rt_tests/calibrate/counted_steps.hpp"
#include "rt_tests/calibrate/price_fit.hpp"
#include "rt_tests/harness/price_table.hpp"

namespace greenloop {
namespace {

constexpr std::uint64_t fewest_steps = 100;

void require_kinds(const NamedModel& model, const CountedSteps& counted) {
  if (counted.way.size() < fewest_steps) {
    throw std::runtime_error(fmt::format("{}: {} steps can be used, of at least {}; give more --cycles", model.name,
                                         counted.way.size(), fewest_steps));
  }
  for (const char* way : {"cached", "cached, field", "fresh", "fresh, field"}) {
    if (std::find(counted.way.begin(), counted.way.end(), way) == counted.way.end()) {
      throw std::runtime_error(
          fmt::format("{}: no step was answered this way: {}; give more --cycles", model.name, way));
    }
  }
}

// steps that prices are fitted to, and ratios of others
class Calibrator {
 public:
  Calibrator(const std::string& unit, bool disturbed) {
    calibration_.unit = unit;
    steps_.disturbed = disturbed;
  }

  // the steps `kept` among those that were counted
  void fit_to(const NamedModel& model, const CountedSteps& counted, const std::vector<double>& costs,
              const std::vector<Eigen::Index>& kept) {
    const Eigen::Index before = steps_.cost.size(), more = static_cast<Eigen::Index>(kept.size());
    steps_.counts.conservativeResize(before + more, counted.counts.cols());
    steps_.counts.bottomRows(more) = counted.counts(kept, Eigen::all);
    steps_.cost.conservativeResize(before + more);
    for (Eigen::Index k = 0; k < more; ++k) {
      const auto i = static_cast<std::size_t>(kept[static_cast<std::size_t>(k)]);
      steps_.cost[before + k] = costs[counted.step[i]];
      steps_.group.push_back(model.name + ": " + counted.way[i]);
    }
  }

  const Prices& fit() {
    calibration_.fitted = steps_.group.size();
    for (Eigen::Index j = 0; j < steps_.counts.cols(); ++j) {
      calibration_.paying.push_back(static_cast<std::uint64_t>((steps_.counts.col(j).array() > 0).count()));
    }
    return calibration_.prices = fit_prices(steps_);
  }

  void predict(const std::string& way, double work, double cost) {
    if (!way.empty()) ratios_[way].push_back(work / cost);
  }

  Calibration finish() {
    std::vector<double> all;
    for (const auto& [way, ratios] : ratios_) {
      calibration_.ways[way] = quantiles(ratios);
      all.insert(all.end(), ratios.begin(), ratios.end());
    }
    calibration_.all = quantiles(std::move(all));
    return std::move(calibration_);
  }

 private:
  FitSteps steps_;
  std::map<std::string, std::vector<double>> ratios_;
  Calibration calibration_;
};

Progress progress(const CalibrationOptions& options, const NamedModel& model, const char* what) {
  return [&options, stage = model.name + ": " + what](double share) {
    if (options.progress) options.progress(stage, share);
  };
}

ScriptOptions scripts(const CalibrationOptions& options, const NamedModel& model, std::uint64_t seed) {
  return {.contacts = options.contacts > 0 ? options.contacts : model.model.view().info->max_contacts,
          .cycles = options.cycles,
          .seed = seed};
}

// places in `counted` of steps for which `is_kept` holds of their place among those that were run
template <class IsKept>
std::vector<Eigen::Index> places(const CountedSteps& counted, IsKept is_kept) {
  std::vector<Eigen::Index> kept;
  for (std::size_t i = 0; i < counted.step.size(); ++i) {
    if (is_kept(counted.step[i])) kept.push_back(static_cast<Eigen::Index>(i));
  }
  return kept;
}

}  // namespace

Calibration calibrate(const std::vector<NamedModel>& models, const CalibrationOptions& options, const Meter& meter) {
  Calibrator calibrator(meter.unit, meter.disturbed);
  for (const NamedModel& model : models) {
    const ScriptOptions of_model = scripts(options, model, options.seed);
    const std::vector<BodySteps> bodies = record_steps(model.model, of_model, counting_prices());
    const std::vector<double> costs =
        meter.costs(model, of_model, counting_prices(), bodies, progress(options, model, "costs"));
    const CountedSteps counted = count_steps(model.model, of_model, bodies, progress(options, model, "counts"));
    require_kinds(model, counted);
    calibrator.fit_to(model, counted, costs, places(counted, [&](std::size_t i) { return costs[i] >= meter.least; }));
  }
  const Prices prices = calibrator.fit();
  for (const NamedModel& model : models) {
    const ScriptOptions of_model = scripts(options, model, options.seed + 1);
    const std::vector<BodySteps> bodies = record_steps(model.model, of_model, prices);
    const std::vector<RanStep> ran = run_steps(model.model, of_model, prices, bodies);
    const std::vector<double> costs = meter.costs(model, of_model, prices, bodies, progress(options, model, "check"));
    for (std::size_t i = 0; i < ran.size(); ++i) {
      if (costs[i] >= meter.least) calibrator.predict(ran[i].way, static_cast<double>(ran[i].work), costs[i]);
    }
  }
  return calibrator.finish();
}

Calibration calibrate(const std::vector<NamedModel>& models, const CalibrationOptions& options,
                      const std::vector<double>& costs, const std::string& unit) {
  constexpr std::size_t stretch = 100;
  const std::size_t of_model = RecordedScript::cycles;
  if (costs.size() != of_model * models.size()) {
    throw std::runtime_error(
        fmt::format("{} costs for {} steps of {} models", costs.size(), of_model * models.size(), models.size()));
  }
  Calibrator calibrator(unit, false);
  const auto is_fitted = [](std::size_t step) { return step / stretch % 2 == 0; };
  std::vector<CountedSteps> counts;
  const auto costs_of = [&](std::size_t m) {
    const auto begin = costs.begin() + static_cast<std::ptrdiff_t>(m * of_model);
    return std::vector<double>(begin, begin + static_cast<std::ptrdiff_t>(of_model));
  };
  for (std::size_t m = 0; m < models.size(); ++m) {
    counts.push_back(count_steps(models[m].model, recorded_options(), record_script(models[m].model, counting_prices()),
                                 progress(options, models[m], "counts")));
    require_kinds(models[m], counts[m]);
    calibrator.fit_to(models[m], counts[m], costs_of(m), places(counts[m], is_fitted));
  }
  const Eigen::VectorXd prices = in_units(calibrator.fit());
  for (std::size_t m = 0; m < models.size(); ++m) {
    const std::vector<double> of_steps = costs_of(m);
    for (const Eigen::Index i : places(counts[m], [&](std::size_t step) { return !is_fitted(step); })) {
      const auto place = static_cast<std::size_t>(i);
      calibrator.predict(counts[m].way[place], counts[m].counts.row(i).dot(prices), of_steps[counts[m].step[place]]);
    }
  }
  return calibrator.finish();
}

}  // namespace greenloop
