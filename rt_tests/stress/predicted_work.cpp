#include "rt_tests/stress/predicted_work.hpp"

#include <algorithm>
#include <cstddef>

#include "rt_tests/harness/contact_script.hpp"
#include "rt_tests/harness/elastostatic_driver.hpp"
#include "runtime/hosted/hosted.hpp"
#include "sim_hw/guard/instruction_counter.hpp"

namespace greenloop {
namespace {

// ratios by the way that a step was answered
using Ratios = std::map<std::string, std::vector<double>>;

template <Driver D>
void count_script(const Model& model, const StressOptions& options, ScriptKind kind, std::uint64_t cycles,
                  std::uint64_t steps, Ratios& ratios) {
  Hosted<typename D::Solver> host(model, D::limits(options.contacts, options.factors));
  ContactScript script(model.view(), D::bounds(host.limits(), host.requirement()), kind, options.seed);
  std::vector<Vec3> force(options.contacts + std::size_t{1});
  const std::uint64_t interval = std::max<std::uint64_t>(1, cycles / steps);
  for (std::uint64_t cycle = 0; cycle < cycles; ++cycle) {
    const ScriptedStep& scripted = script.next();
    const bool counted = cycle % interval == interval - 1 && scripted.contacts.size() <= force.size();
    if (!counted) {
      host.step(scripted.contacts, scripted.budget, scripted.with_field);
      continue;
    }
    const typename D::Solver::Response response{std::span(force).first(scripted.contacts.size()),
                                                as_vec4(scripted.with_field ? host.field() : std::span<float>())};
    instruction_counter::start();
    const auto report = host.body().step(scripted.contacts, {scripted.budget}, response);
    const auto instructions = static_cast<double>(instruction_counter::stop());
    if (answered(report.status)) {
      ratios[D::way(report, scripted.with_field)].push_back(static_cast<double>(report.work) / instructions);
    }
  }
}

}  // namespace

RatioQuantiles quantiles(std::vector<double> ratios) {
  if (ratios.empty()) {
    return {};
  }
  std::sort(ratios.begin(), ratios.end());
  const auto at = [&](double share) {
    return ratios[static_cast<std::size_t>(share * static_cast<double>(ratios.size() - 1) + 0.5)];
  };
  return {ratios.size(), ratios.front(), at(0.05), at(0.5), at(0.95), ratios.back()};
}

template <Driver D>
PredictedWork compare_work(const Model& model, const StressOptions& options, std::uint64_t steps) {
  PredictedWork compared;
  if (!instruction_counter::install()) {
    return compared;
  }
  Ratios ratios;
  visit_scripts(options, [&](ScriptKind kind, std::uint64_t cycles) {
    count_script<D>(model, options, kind, cycles, steps, ratios);
  });
  std::vector<double> all;
  for (const auto& [way, of_way] : ratios) {
    all.insert(all.end(), of_way.begin(), of_way.end());
    compared.ways[way] = quantiles(of_way);
  }
  compared.all = quantiles(std::move(all));
  return compared;
}

template PredictedWork compare_work<ElastostaticDriver>(const Model&, const StressOptions&, std::uint64_t);

}  // namespace greenloop
