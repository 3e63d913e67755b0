// greenloop-stress: random and adversarial contacts on a model, impulses on its motions, or loads and holds on a
// multigrid model, every step checked against what the runtime declares.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "formats/output/json_text.hpp"
#include "formats/output/program.hpp"
#include "formats/output/streams.hpp"
#include "formats/write/describe.hpp"
#include "formats/write/model_file.hpp"
#include "offline/pipeline/progress_bar.hpp"
#include "rt_tests/harness/loaded_driver.hpp"
#include "rt_tests/harness/prices_file.hpp"
#include "rt_tests/harness/time_of.hpp"
#include "rt_tests/stress/elastic_stress.hpp"
#include "rt_tests/stress/impulse_stress.hpp"
#include "rt_tests/stress/stress_report.hpp"
#include "rt_tests/stress/tool_stress.hpp"

namespace {

using greenloop::ElasticScriptKind;
using greenloop::ElasticStressReport;
using greenloop::ElastostaticDriver;
using greenloop::ImpulseScriptKind;
using greenloop::ImpulseStressReport;
using greenloop::InjectedFault;
using greenloop::ScriptKind;
using greenloop::StressReport;
using greenloop::ToolScriptKind;
using greenloop::ToolStressReport;

struct Arguments {
  std::string model;
  greenloop::StressOptions options;
  std::string script;
  bool loads = false, tools = false;
  bool json = false;
  bool count_instructions = false, list_steps = false;
  double rate = 0;
  double share = 0;
  bool judge_time = false;
  std::string prices;
};

// all names of scripts, of any model
std::vector<std::string> script_names() {
  std::vector<std::string> names(greenloop::contact_script_names.begin(), greenloop::contact_script_names.end());
  names.insert(names.end(), greenloop::tool_script_names.begin(), greenloop::tool_script_names.end());
  names.insert(names.end(), greenloop::impulse_script_names.begin(), greenloop::impulse_script_names.end());
  names.insert(names.end(), greenloop::elastic_script_names.begin(), greenloop::elastic_script_names.end());
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

// the script that was asked for, among those of a kind of model; none: all of them
template <class Kind, class Names>
std::optional<Kind> script_of(const std::string& script, const Names& names, const char* others) {
  if (script.empty()) return std::nullopt;
  const auto found = std::find(names.begin(), names.end(), script);
  if (found == names.end()) throw std::runtime_error("--script " + script + " is one of " + others);
  return static_cast<Kind>(found - names.begin());
}

/// An option of names that stand for values.
template <class Target, class Value>
void add_choice(CLI::App& app, const std::string& option, Target& target, const std::map<std::string, Value>& choices,
                const std::string& help) {
  std::vector<std::string> names;
  for (const auto& [name, value] : choices) names.push_back(name);
  app.add_option_function<std::string>(
         option, [&target, choices](const std::string& name) { target = choices.at(name); }, help)
      ->check(CLI::IsMember(names));
}

void declare(CLI::App& app, Arguments& arguments) {
  greenloop::StressOptions& options = arguments.options;
  app.add_option("MODEL", arguments.model, "model file (.gloop)")->required()->check(CLI::ExistingFile);
  app.add_option("--cycles", options.cycles, "steps to run, shared among the scripts")
      ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1} << 40))
      ->capture_default_str();
  app.add_option("--seed", options.seed, "of the scripts")->capture_default_str();
  app.add_option("--script", arguments.script, "this script alone; else all, each on a body of its own")
      ->check(CLI::IsMember(script_names()));
  app.add_option("--contacts", options.contacts, "most contacts of a step; else what the model asks for")
      ->check(CLI::Range(1, 4096));
  app.add_option("--factors", options.factors, "cached factors")->check(CLI::Range(1, 1024))->capture_default_str();
  app.add_option("--histogram", options.histogram_bins, "bins of the histogram, one microsecond each")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  app.add_flag("--instructions,!--no-instructions", arguments.count_instructions,
               "count those of every step, and of the heaviest kind of step, by Valgrind: some fifty times as long");
  app.add_flag("--list-steps", arguments.list_steps, "only run the steps, and print what each reports")->group("");
  app.add_option("--budget", options.budget, "work units of every counted step; else the scripts'")
      ->check(CLI::PositiveNumber);
  app.add_option("--prices", arguments.prices, "JSON file of prices in place of the default ones")
      ->check(CLI::ExistingFile);
  app.add_option("--rate", arguments.rate,
                 "Hz, whose period steps are compared with; else the model's. Of motions it is the loop's, which steps")
      ->check(CLI::PositiveNumber);
  app.add_option("--share", arguments.share, "of the period that a step may take; else the model's")
      ->check(CLI::Range(0.001, 1.0));
  app.add_flag("--judge-time", arguments.judge_time,
               "fail if a step takes longer, or if this machine cannot tell: it takes a thread that is pinned to one "
               "isolated processor");
  app.add_flag("--tools", arguments.tools, "rigid tools that touch the body in place of contacts");
  app.add_flag("--loads", arguments.loads, "known forces, masks and gravity beside the contacts of the scripts");
  app.add_flag("--json", arguments.json, "machine-readable result");
  const std::map<std::string, InjectedFault> faults = {{"allocation", InjectedFault::allocation},
                                                       {"lock", InjectedFault::lock},
                                                       {"system-call", InjectedFault::system_call},
                                                       {"page-fault", InjectedFault::page_fault},
                                                       {"overrun", InjectedFault::overrun}};
  add_choice(app, "--inject", options.fault, faults, "a fault in every hundredth step, to see the verdict fail");
}

// that lists the same steps in another process
std::vector<std::string> listing(const Arguments& arguments) {
  return {std::filesystem::read_symlink("/proc/self/exe").string(),
          arguments.model,
          "--list-steps",
          "--cycles",
          std::to_string(arguments.options.cycles),
          "--seed",
          std::to_string(arguments.options.seed)};
}

greenloop::PredictedWork count_instructions(const std::string& solver, const std::vector<std::string>& command) {
  std::string out;
  const std::vector<std::uint64_t> instructions = greenloop::count_step_instructions(solver, command, out);
  std::istringstream lines(out);
  return greenloop::compare(greenloop::read_steps(lines), instructions);
}

greenloop::PredictedWork count_instructions(const Arguments& arguments, const greenloop::StressOptions& options) {
  std::vector<std::string> command = listing(arguments);
  command.insert(command.end(),
                 {"--contacts", std::to_string(options.contacts), "--factors", std::to_string(options.factors)});
  if (!arguments.prices.empty()) {
    command.insert(command.end(), {"--prices", arguments.prices});
  }
  if (options.budget > 0) {
    command.insert(command.end(), {"--budget", std::to_string(options.budget)});
  }
  if (arguments.loads) {
    command.emplace_back("--loads");
  }
  if (options.script) {
    command.insert(command.end(), {"--script", greenloop::name(*options.script)});
  }
  return count_instructions("Elastostatic", command);
}

// the options for a model
greenloop::StressOptions options_for(const greenloop::Model& model, const Arguments& arguments) {
  greenloop::StressOptions options = arguments.options;
  if (options.contacts == 0) {
    options.contacts = model.view().info->max_contacts;
  }
  if (!arguments.prices.empty()) {
    options.prices = greenloop::read_prices(arguments.prices);
  }
  options.script = script_of<ScriptKind>(arguments.script, greenloop::contact_script_names, "tools: give --tools");
  return options;
}

double rate_of(const Arguments& arguments, const greenloop::Elastostatic::Intent& intent) {
  return arguments.rate > 0 ? arguments.rate : double{intent.rate};
}

double share_of(const Arguments& arguments, const greenloop::Elastostatic::Intent& intent) {
  return arguments.share > 0 ? arguments.share : double{intent.share};
}

// the result of `run`, which tells of its progress, and how long it took
template <class Report, class Run>
void run_with_progress(Report& report, greenloop::offline::ProgressBar& bar, Run run) {
  bar.begin("stress");
  report.options.progress = [&](auto kind, std::uint64_t done) {
    bar.update(static_cast<double>(done) / static_cast<double>(report.options.cycles), name(kind));
  };
  const auto begin = std::chrono::steady_clock::now();
  report.result = run();
  const std::chrono::duration<double, std::ratio<60>> minutes = std::chrono::steady_clock::now() - begin;
  report.minutes_per_million = minutes.count() / (static_cast<double>(report.result.cycles) / 1e6);
  bar.end(fmt::format("{} cycles", report.result.cycles));
}

ToolStressReport stress_tools(const greenloop::Model& model, const Arguments& arguments) {
  constexpr std::uint32_t usual_contacts = 64;
  const greenloop::StressOptions& asked = arguments.options;
  ToolStressReport report;
  report.model = arguments.model;
  greenloop::ToolStressOptions& options = report.options;
  options.cycles = asked.cycles;
  options.seed = asked.seed;
  options.script = script_of<ToolScriptKind>(arguments.script, greenloop::tool_script_names, "contacts, not of tools");
  options.contacts = asked.contacts == 0 ? usual_contacts : asked.contacts;
  options.factors = asked.factors;
  options.histogram_bins = asked.histogram_bins;
  options.fault = asked.fault;
  greenloop::offline::ProgressBar bar(arguments.json);
  run_with_progress(report, bar, [&] { return greenloop::run_tool_stress(model, options); });
  const auto intent = greenloop::Elastostatic::intended(model);
  report.time = greenloop::judge_times(report.result.times, rate_of(arguments, intent), share_of(arguments, intent),
                                       arguments.judge_time);
  return report;
}

// instructions of the steps of `body`, of the report's scripts; with --rate only where it was given
template <class Report>
void count_scripts(Report& report, const char* body, const Arguments& arguments, greenloop::offline::ProgressBar& bar) {
  std::vector<std::string> command = listing(arguments);
  const auto& options = report.options;
  if (options.script) command.insert(command.end(), {"--script", name(*options.script)});
  if (options.budget > 0) command.insert(command.end(), {"--budget", std::to_string(options.budget)});
  if (arguments.rate > 0) command.insert(command.end(), {"--rate", fmt::format("{}", arguments.rate)});
  bar.begin("instructions");
  report.predicted = count_instructions(body, command);
  bar.end(fmt::format("of {} steps", report.predicted->all.steps));
}

// the options for motions; throws std::runtime_error for those that contacts alone have
greenloop::ImpulseStressOptions motion_options(const Arguments& arguments) {
  const greenloop::StressOptions& asked = arguments.options;
  if (arguments.tools || arguments.loads || asked.contacts > 0 || !arguments.prices.empty()) {
    throw std::runtime_error(arguments.model + ": motions have no --tools, --loads, --contacts or --prices");
  }
  return {.cycles = asked.cycles,
          .seed = asked.seed,
          .script = script_of<ImpulseScriptKind>(arguments.script, greenloop::impulse_script_names,
                                                 "contacts or tools, not of impulses"),
          .limits = {.rate = static_cast<float>(arguments.rate)},
          .budget = asked.budget,
          .histogram_bins = asked.histogram_bins,
          .fault = asked.fault};
}

ImpulseStressReport stress_motions(const greenloop::Model& model, const Arguments& arguments) {
  ImpulseStressReport report{.model = arguments.model, .options = motion_options(arguments)};
  greenloop::ImpulseStressOptions& options = report.options;
  const float rate = options.limits.rate;
  report.rate = static_cast<double>(rate > 0 ? rate : model.view().impulse_response.info->rate);
  greenloop::offline::ProgressBar bar(arguments.json);
  run_with_progress(report, bar, [&] { return greenloop::run_impulse_stress(model, options); });
  report.time = greenloop::judge_times(report.result.times, report.rate, arguments.share > 0 ? arguments.share : 1,
                                       arguments.judge_time);
  if (arguments.count_instructions) count_scripts(report, "ImpulseResponse", arguments, bar);
  return report;
}

// the options for a multigrid model; throws std::runtime_error for those that others have
greenloop::ElasticStressOptions elastic_options(const Arguments& arguments) {
  const greenloop::StressOptions& asked = arguments.options;
  if (arguments.tools || arguments.loads || asked.contacts > 0 || !arguments.prices.empty() || arguments.rate > 0) {
    throw std::runtime_error(arguments.model +
                             ": multigrid models have no --tools, --loads, --contacts, --prices or --rate");
  }
  return {.cycles = asked.cycles,
          .seed = asked.seed,
          .script = script_of<ElasticScriptKind>(arguments.script, greenloop::elastic_script_names,
                                                 "contacts, tools or impulses, not of multigrid models"),
          .budget = asked.budget,
          .histogram_bins = asked.histogram_bins,
          .fault = asked.fault};
}

ElasticStressReport stress_elastic(const greenloop::Model& model, const Arguments& arguments) {
  ElasticStressReport report{.model = arguments.model, .options = elastic_options(arguments)};
  const greenloop::ElasticStressOptions& options = report.options;
  report.rate = 1 / model.view().multigrid.info->time_step;
  greenloop::offline::ProgressBar bar(arguments.json);
  run_with_progress(report, bar, [&] { return greenloop::run_elastic_stress(model, options); });
  report.time = greenloop::judge_times(report.result.times, report.rate, arguments.share > 0 ? arguments.share : 1,
                                       arguments.judge_time);
  if (arguments.count_instructions) count_scripts(report, "Multigrid", arguments, bar);
  return report;
}

template <class Report>
int hand_out(const Report& report, bool as_json) {
  if (as_json) {
    greenloop::print_result(greenloop::json_text(report.json()) + "\n");
  } else {
    report.print();
  }
  return report.held() ? 0 : 1;
}

StressReport stress(const greenloop::Model& model, const Arguments& arguments) {
  StressReport report{.model = arguments.model, .options = options_for(model, arguments)};
  greenloop::StressOptions& options = report.options;
  greenloop::offline::ProgressBar bar(arguments.json);
  run_with_progress(report, bar, [&] {
    return arguments.loads ? greenloop::run_stress<greenloop::LoadedDriver>(model, options)
                           : greenloop::run_stress<ElastostaticDriver>(model, options);
  });
  const auto intent = greenloop::Elastostatic::intended(model);
  report.time = greenloop::judge_times(report.result.times, rate_of(arguments, intent), share_of(arguments, intent),
                                       arguments.judge_time);
  report.starved = greenloop::starved_steps<ElastostaticDriver>(model, options, 1600);
  if (arguments.count_instructions) {
    bar.begin("instructions");
    report.predicted = count_instructions(arguments, options);
    bar.end(fmt::format("of {} steps", report.predicted->all.steps));
  }
  return report;
}

int run(const Arguments& arguments) {
  const greenloop::AlignedBytes bytes = greenloop::load_file(arguments.model);
  const auto opened = greenloop::Model::open(bytes.span());
  if (!opened) {
    throw std::runtime_error(arguments.model + ": " + greenloop::describe(opened.result));
  }
  const auto measure_opening = [&] {
    return greenloop::time_of(15, [&] { (void)greenloop::Model::open(bytes.span()); }) / 1e3;
  };
  if (opened.model.problem() == greenloop::layout::Problem::impulse_response) {
    if (arguments.list_steps) {
      greenloop::write_steps(greenloop::run_impulses_plainly(opened.model, motion_options(arguments)), std::cout);
      return 0;
    }
    ImpulseStressReport report = stress_motions(opened.model, arguments);
    report.open_ms = measure_opening();
    return hand_out(report, arguments.json);
  }
  if (opened.model.problem() == greenloop::layout::Problem::multigrid) {
    if (arguments.list_steps) {
      greenloop::write_steps(greenloop::run_elastic_plainly(opened.model, elastic_options(arguments)), std::cout);
      return 0;
    }
    ElasticStressReport report = stress_elastic(opened.model, arguments);
    report.open_ms = measure_opening();
    return hand_out(report, arguments.json);
  }
  greenloop::require_problem(opened.model.view(), greenloop::layout::Problem::elastostatic, arguments.model);
  if (arguments.list_steps) {
    const auto options = options_for(opened.model, arguments);
    greenloop::write_steps(arguments.loads ? greenloop::run_plainly<greenloop::LoadedDriver>(opened.model, options)
                                           : greenloop::run_plainly<ElastostaticDriver>(opened.model, options),
                           std::cout);
    return 0;
  }
  if (arguments.tools) return hand_out(stress_tools(opened.model, arguments), arguments.json);
  StressReport report = stress(opened.model, arguments);
  report.open_ms = measure_opening();
  return hand_out(report, arguments.json);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Random and adversarial contacts on a model, impulses on its motions, or loads and holds on a multigrid model; "
      "every step is checked against its declared work.",
      "greenloop-stress");
  Arguments arguments;
  arguments.options.contacts = 0;
  declare(app, arguments);
  return greenloop::run_program(app, argc, argv, [&] { return run(arguments); });
}
