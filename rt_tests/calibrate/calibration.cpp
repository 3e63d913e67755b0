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
constexpr double shortest = 100;  // ns: what a clock can tell

class Calibrator {
 public:
  Calibrator(const std::vector<NamedModel>& models, const CalibrationOptions& options, const Stopwatch& stopwatch)
      : models_(models), options_(options), stopwatch_(stopwatch) {}

  Calibration run() {
    for (const NamedModel& model : models_) measure(model);
    calibration_.prices = fit_prices(steps_);
    note_paying();
    for (const NamedModel& model : models_) predict(model);
    note_ratios();
    return calibration_;
  }

 private:
  ScriptOptions scripts(const NamedModel& model, std::uint64_t seed) const {
    return {.contacts = options_.contacts > 0 ? options_.contacts : model.model.view().info->max_contacts,
            .cycles = options_.cycles,
            .seed = seed};
  }

  std::function<void(double)> progress(const NamedModel& model, const char* what, double from, double to) const {
    return [=, this, stage = model.name + ": " + what](double share) {
      if (options_.progress) options_.progress(stage, from + (to - from) * share);
    };
  }

  // counts and times of a model's steps, with the seeds that prices are fitted to
  void measure(const NamedModel& model) {
    const ScriptOptions options = scripts(model, options_.seed);
    const Prices prices = counting_prices();
    const std::vector<BodySteps> bodies = record_steps(model.model, options, prices);
    const std::vector<double> ns = least_times(model.model, options, prices, bodies, options_.repetitions, stopwatch_,
                                               progress(model, "times", 0, 0.15));
    const CountedSteps counted = count_steps(model.model, options, bodies, progress(model, "counts", 0.15, 1));
    require_kinds(model, counted);
    add(model, counted, ns);
  }

  static void require_kinds(const NamedModel& model, const CountedSteps& counted) {
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

  // those that are long enough
  void add(const NamedModel& model, const CountedSteps& counted, const std::vector<double>& ns) {
    std::vector<Eigen::Index> kept;
    for (std::size_t i = 0; i < counted.step.size(); ++i) {
      if (ns[counted.step[i]] >= shortest) kept.push_back(static_cast<Eigen::Index>(i));
    }
    const Eigen::Index before = steps_.ns.size(), more = static_cast<Eigen::Index>(kept.size());
    steps_.counts.conservativeResize(before + more, counted.counts.cols());
    steps_.counts.bottomRows(more) = counted.counts(kept, Eigen::all);
    steps_.ns.conservativeResize(before + more);
    for (Eigen::Index k = 0; k < more; ++k) {
      const auto i = static_cast<std::size_t>(kept[static_cast<std::size_t>(k)]);
      steps_.ns[before + k] = ns[counted.step[i]];
      steps_.group.push_back(model.name + ": " + counted.way[i]);
    }
  }

  void note_paying() {
    calibration_.fitted = steps_.group.size();
    for (Eigen::Index j = 0; j < steps_.counts.cols(); ++j) {
      calibration_.paying.push_back(static_cast<std::uint64_t>((steps_.counts.col(j).array() > 0).count()));
    }
  }

  // steps of the other seeds, of bodies with the prices that were found
  void predict(const NamedModel& model) {
    const ScriptOptions options = scripts(model, options_.seed + 1);
    const std::vector<BodySteps> bodies = record_steps(model.model, options, calibration_.prices);
    const std::vector<RanStep> ran = run_steps(model.model, options, calibration_.prices, bodies);
    const std::vector<double> ns = least_times(model.model, options, calibration_.prices, bodies, options_.repetitions,
                                               stopwatch_, progress(model, "check", 0, 1));
    for (std::size_t i = 0; i < ran.size(); ++i) {
      if (ran[i].way.empty() || ns[i] < shortest) continue;
      ratios_[ran[i].way].push_back(static_cast<double>(ran[i].work) / ns[i]);
    }
  }

  void note_ratios() {
    std::vector<double> all;
    for (const auto& [way, ratios] : ratios_) {
      calibration_.ways[way] = quantiles(ratios);
      all.insert(all.end(), ratios.begin(), ratios.end());
    }
    calibration_.all = quantiles(std::move(all));
  }

  const std::vector<NamedModel>& models_;
  const CalibrationOptions& options_;
  const Stopwatch& stopwatch_;
  FitSteps steps_;
  std::map<std::string, std::vector<double>> ratios_;
  Calibration calibration_;
};

}  // namespace

Calibration calibrate(const std::vector<NamedModel>& models, const CalibrationOptions& options,
                      const Stopwatch& stopwatch) {
  return Calibrator(models, options, stopwatch).run();
}

}  // namespace greenloop
