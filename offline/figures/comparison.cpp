#include "offline/figures/comparison.hpp"

#include <algorithm>

#include "offline/figures/two_sided_form.hpp"

namespace greenloop::offline {
namespace {

constexpr double default_quantum = 0.5;  // of the threshold
constexpr double growth_errors[] = {0.005, 0.01, 0.02, 0.05, 0.1};

void try_quanta(const TwoSidedForm& form, const ComparisonPlan& plan, BodyComparison& result) {
  for (const double quantum : plan.quanta) {
    const bool known = quantum == default_quantum;
    const auto levels = known ? result.forms.back().two_sided : form.rates(plan.two_sided_thresholds, quantum);
    result.quanta.push_back({quantum, levels.back().points});
  }
}

void time_fields(const TwoSidedForm& form, const ComparisonPlan& plan, BodyComparison& result) {
  for (const double threshold : plan.summation_thresholds) {
    result.summation.push_back(time_summation(form.model(threshold), plan.contacts, plan.rounds));
  }
}

// reports on a part of the work
Progress part(const Progress& progress, double begin, double end) {
  return [progress, begin, end](double fraction, std::string_view stage) {
    if (progress) progress(begin + (end - begin) * fraction, stage);
  };
}

std::optional<double> quotient(std::optional<double> a, std::optional<double> b) {
  return a && b ? std::optional(*a / *b) : std::nullopt;
}

std::optional<double> ratio_at(const std::vector<LevelRates>& levels, double rms) {
  return interpolate(levels.back().points, &RatePoint::rms, rms, &RatePoint::ratio);
}

}  // namespace

BodyComparison compare_forms(const ExactBody& body, const ComparisonPlan& plan, const Progress& progress) {
  BodyComparison result{.name = body.name, .rows = 0, .forms = {}, .quanta = {}, .summation = {}};
  double floor = *std::min_element(plan.summation_thresholds.begin(), plan.summation_thresholds.end());
  for (const double threshold : plan.two_sided_thresholds) floor = std::min(floor, threshold);
  double done = 0;
  constexpr double share = 1.0 / std::size(wavelet_kinds);
  for (const WaveletKind& kind : wavelet_kinds) {
    FormRates rates{
        .wavelet = std::string(kind.name),
        .column = column_form_rates(body, kind, plan.column_thresholds, part(progress, done, done + 0.4 * share)),
        .two_sided = {}};
    const TwoSidedForm form(body, kind, floor, part(progress, done + 0.4 * share, done + 0.7 * share));
    done += share;
    rates.two_sided = form.rates(plan.two_sided_thresholds, default_quantum);
    result.forms.push_back(std::move(rates));
    if (&kind != std::end(wavelet_kinds) - 1) continue;
    result.rows = form.rows();
    try_quanta(form, plan, result);
    time_fields(form, plan, result);
  }
  return result;
}

std::vector<Growth> growth(std::vector<BodyComparison> bodies) {
  std::sort(bodies.begin(), bodies.end(),
            [](const BodyComparison& a, const BodyComparison& b) { return a.rows < b.rows; });
  std::vector<Growth> steps;
  for (std::size_t i = 1; i < bodies.size(); ++i) {
    const FormRates &small = bodies[i - 1].forms.back(), &large = bodies[i].forms.back();
    for (const double rms : growth_errors) {
      steps.push_back({.from = bodies[i - 1].name,
                       .to = bodies[i].name,
                       .rms = rms,
                       .column = quotient(ratio_at(large.column, rms), ratio_at(small.column, rms)),
                       .two_sided = quotient(ratio_at(large.two_sided, rms), ratio_at(small.two_sided, rms))});
    }
  }
  return steps;
}

}  // namespace greenloop::offline
