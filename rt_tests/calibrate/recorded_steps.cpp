#include "rt_tests/calibrate/recorded_steps.hpp"

#include <algorithm>
#include <iterator>
#include <stdexcept>

#include "runtime/hosted/thread_clock.hpp"

namespace greenloop {
namespace {

using Host = Hosted<Elastostatic>;

constexpr std::size_t kinds = contact_script_names.size() - 2;

// all kinds but the one whose steps are refused and, last, the hunt for dear ones
constexpr ScriptKind kind_of(std::size_t k) {
  return static_cast<ScriptKind>(k < static_cast<std::size_t>(ScriptKind::garbage) ? k : k + 1);
}

Host host_of(const Model& model, const ScriptOptions& options, const Prices& prices) {
  return {model, ElastostaticDriver::limits(options.contacts, options.factors, prices)};
}

// of `whole` in `parts`, the first ones larger
constexpr std::uint64_t share(std::uint64_t whole, std::uint64_t parts, std::uint64_t i) {
  return whole / parts + (i < whole % parts ? 1 : 0);
}

// of the declared worst work, that every step of a body may spend; 0: the scripts' own budgets
constexpr double shares[] = {0, 0, 1.0 / 4, 1.0 / 16, 1.0 / 64, 1.0 / 256};

BodySteps steps_of_body(const Model& model, const ScriptBounds& bounds, std::uint64_t seed, std::uint64_t cycles) {
  BodySteps steps;
  for (std::size_t k = 0; k < kinds; ++k) {
    ContactScript script(model.view(), bounds, kind_of(k), seed);
    for (std::uint64_t i = 0; i < share(cycles, kinds, k); ++i) steps.push_back(script.next());
  }
  return steps;
}

void limit(BodySteps& steps, const ScriptBounds& bounds, double share) {
  const auto budget = static_cast<std::uint64_t>(share * static_cast<double>(bounds.worst_work));
  for (ScriptedStep& step : steps) step.budget = std::max(bounds.least_work, budget);
}

std::string way_of(const ScriptedStep& step, const Elastostatic::StepReport& report) {
  if (!answered(report.status)) return {};
  return ElastostaticDriver::way(report, step.with_field);
}

double nanoseconds_of(const std::function<void()>& work) {
  const std::int64_t begin = thread_nanoseconds();
  work();
  return static_cast<double>(thread_nanoseconds() - begin);
}

}  // namespace

std::vector<BodySteps> record_steps(const Model& model, const ScriptOptions& options, const Prices& prices) {
  const Host host = host_of(model, options, prices);
  ScriptBounds bounds = ElastostaticDriver::bounds(host.limits(), host.requirement());
  bounds.least_work += bounds.least_work / 100;  // so that it is enough still when a price rises a little
  std::vector<BodySteps> bodies;
  for (std::uint64_t i = 0; i < std::size(shares); ++i) {
    const std::uint64_t cycles = share(options.cycles, std::size(shares), i);
    bodies.push_back(steps_of_body(model, bounds, options.seed + 2 * i, cycles));
    if (shares[i] > 0) limit(bodies.back(), bounds, shares[i]);
  }
  return bodies;
}

std::vector<BodySteps> record_script(const Model& model, const Prices& prices) {
  const ScriptOptions options = recorded_options();
  const Host host = host_of(model, options, prices);
  RecordedScript script(model, ElastostaticDriver::bounds(host.limits(), host.requirement()));
  if (!script.usable()) throw std::runtime_error("the recorded script has no use for such a model");
  BodySteps steps(RecordedScript::cycles);
  for (ScriptedStep& step : steps) {
    const RecordedScript::Cycle cycle = script.next();
    step = {{cycle.contacts.begin(), cycle.contacts.end()}, cycle.budget.work, cycle.with_field};
  }
  return {steps};
}

std::vector<RanStep> run_steps(const Model& model, const ScriptOptions& options, const Prices& prices,
                               const std::vector<BodySteps>& bodies, const Stopwatch& stopwatch) {
  Host host = host_of(model, options, prices);
  std::vector<RanStep> ran;
  for (const BodySteps& steps : bodies) {
    host.renew();
    for (const ScriptedStep& step : steps) {
      Elastostatic::StepReport report;
      const double ns = stopwatch([&] { report = host.step(step.contacts, step.budget, step.with_field); });
      ran.push_back({way_of(step, report), report.work, ns});
    }
  }
  return ran;
}

std::vector<RanStep> run_steps(const Model& model, const ScriptOptions& options, const Prices& prices,
                               const std::vector<BodySteps>& bodies) {
  return run_steps(model, options, prices, bodies, [](const std::function<void()>& work) {
    work();
    return 0.0;
  });
}

Stopwatch thread_stopwatch() {
  constexpr int readings = 1000;
  double reading = nanoseconds_of([] {});
  for (int i = 0; i < readings; ++i) reading = std::min(reading, nanoseconds_of([] {}));
  return [reading](const std::function<void()>& work) { return std::max(nanoseconds_of(work) - reading, 1.0); };
}

}  // namespace greenloop
