// greenloop-stress: random and adversarial contacts on a model, every step checked against what the runtime declares.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <exception>
#include <map>

#include "formats/write/describe.hpp"
#include "formats/write/model_file.hpp"
#include "offline/pipeline/progress_bar.hpp"
#include "rt_tests/harness/elastostatic_driver.hpp"
#include "rt_tests/stress/heaviest_step.hpp"
#include "rt_tests/stress/stress_report.hpp"

namespace {

using greenloop::ElastostaticDriver;
using greenloop::InjectedFault;
using greenloop::ScriptKind;
using greenloop::StressReport;

struct Arguments {
  std::string model;
  greenloop::StressOptions options;
  bool json = false;
  bool count_instructions = true;
};

std::map<std::string, ScriptKind> script_kinds() {
  std::map<std::string, ScriptKind> kinds;
  for (std::size_t i = 0; i < greenloop::contact_script_names.size(); ++i) {
    kinds[greenloop::contact_script_names[i]] = static_cast<ScriptKind>(i);
  }
  return kinds;
}

void declare(CLI::App& app, Arguments& arguments) {
  greenloop::StressOptions& options = arguments.options;
  app.add_option("MODEL", arguments.model, "model file (.gloop)")->required()->check(CLI::ExistingFile);
  app.add_option("--cycles", options.cycles, "steps to run, shared among the scripts")
      ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1} << 40))
      ->capture_default_str();
  app.add_option("--seed", options.seed, "of the scripts")->capture_default_str();
  app.add_option("--script", options.script, "this script alone; else all, each on a body of its own")
      ->transform(CLI::CheckedTransformer(script_kinds()));
  app.add_option("--contacts", options.contacts, "most contacts of a step; else what the model asks for")
      ->check(CLI::Range(1, 4096));
  app.add_option("--factors", options.factors, "cached factors")->check(CLI::Range(1, 1024))->capture_default_str();
  app.add_option("--histogram", options.histogram_bins, "bins of the histogram, one microsecond each")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  app.add_flag("--instructions,!--no-instructions", arguments.count_instructions,
               "count those of the heaviest kind of step, of which each takes microseconds: a minute or more");
  app.add_flag("--json", arguments.json, "machine-readable result");
  const std::map<std::string, InjectedFault> faults = {{"allocation", InjectedFault::allocation},
                                                       {"lock", InjectedFault::lock},
                                                       {"system-call", InjectedFault::system_call},
                                                       {"page-fault", InjectedFault::page_fault},
                                                       {"overrun", InjectedFault::overrun}};
  app.add_option("--inject", options.fault, "a fault in every hundredth step, to see the verdict fail")
      ->transform(CLI::CheckedTransformer(faults, CLI::ignore_case));
}

StressReport stress(const Arguments& arguments) {
  const greenloop::AlignedBytes bytes = greenloop::load_file(arguments.model);
  const auto opened = greenloop::Model::open(bytes.span());
  if (!opened) {
    throw std::runtime_error(arguments.model + ": " + greenloop::describe(opened.result));
  }
  greenloop::require_problem(opened.model.view(), greenloop::layout::Problem::elastostatic, arguments.model);
  StressReport report{.model = arguments.model, .options = arguments.options, .result = {}};
  greenloop::StressOptions& options = report.options;
  if (options.contacts == 0) {
    options.contacts = opened.model.view().info->max_contacts;
  }
  greenloop::offline::ProgressBar bar(arguments.json);
  bar.begin("stress");
  options.progress = [&](ScriptKind kind, std::uint64_t done) {
    bar.update(static_cast<double>(done) / static_cast<double>(options.cycles), name(kind));
  };
  const auto begin = std::chrono::steady_clock::now();
  report.result = greenloop::run_stress<ElastostaticDriver>(opened.model, options);
  const std::chrono::duration<double, std::ratio<60>> minutes = std::chrono::steady_clock::now() - begin;
  report.minutes_per_million = minutes.count() / (static_cast<double>(report.result.cycles) / 1e6);
  bar.end(fmt::format("{} cycles", report.result.cycles));
  if (arguments.count_instructions) {
    bar.begin("instructions");
    report.instructions_max =
        greenloop::instructions_of_heaviest_step<ElastostaticDriver>(opened.model, options.contacts, options.factors);
    bar.end("of the heaviest step");
  }
  return report;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Random and adversarial contacts on a model; every step is checked against its declared work.");
  Arguments arguments;
  arguments.options.contacts = 0;
  declare(app, arguments);
  CLI11_PARSE(app, argc, argv);
  try {
    const StressReport report = stress(arguments);
    if (arguments.json) {
      fmt::print("{}\n", report.json().dump(2));
    } else {
      report.print();
    }
    return report.result.held() ? 0 : 1;
  } catch (const std::exception& error) {
    fmt::print(stderr, "greenloop-stress: {}\n", error.what());
    return 2;
  }
}
