// greenloop-calibrate: what the work of a step costs on this machine, or on another that counted.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <list>
#include <stdexcept>
#include <string>
#include <vector>

#include "formats/output/json_text.hpp"
#include "formats/output/output_file.hpp"
#include "formats/output/output_paths.hpp"
#include "formats/output/program.hpp"
#include "formats/output/streams.hpp"
#include "formats/write/describe.hpp"
#include "formats/write/model_file.hpp"
#include "offline/pipeline/progress_bar.hpp"
#include "rt_tests/calibrate/calibration_report.hpp"
#include "rt_tests/harness/prices_file.hpp"

namespace {

struct Arguments {
  std::vector<std::string> models;
  greenloop::CalibrationOptions options;
  std::string output;
  bool instructions = false;
  std::string costs, unit = "instructions";
  bool json = false;
  bool run_steps = false;
  std::string prices;
};

void declare(CLI::App& app, Arguments& arguments) {
  greenloop::CalibrationOptions& options = arguments.options;
  app.add_option("MODEL", arguments.models, "model files (.gloop)")->required()->check(CLI::ExistingFile);
  app.add_option("--contacts", options.contacts, "most contacts of a step; else what each model asks for")
      ->check(CLI::Range(1, 4096));
  app.add_option("--cycles", options.cycles, "steps of each model to fit prices to; as many again are predicted")
      ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1} << 24))
      ->capture_default_str();
  app.add_option("--seed", options.seed, "of the contacts")->capture_default_str();
  CLI::Option* instructions = app.add_flag("--instructions", arguments.instructions,
                                           "prices in instructions, counted by Valgrind, in place of nanoseconds");
  app.add_option("--costs", arguments.costs,
                 "prices of another processor: a file with what each step of the recorded script took there on the "
                 "models, a number a line")
      ->check(CLI::ExistingFile)
      ->excludes(instructions);
  app.add_option("--unit", arguments.unit, "of --costs, in words")->capture_default_str();
  app.add_flag("--run-steps", arguments.run_steps, "only run the steps of a model")->group("");
  app.add_option("--prices", arguments.prices, "of those steps")->group("")->check(CLI::ExistingFile);
  app.add_option("-o,--output", arguments.output, "the prices: .json for --prices of greenloop-stress, .hpp for C++");
  app.add_flag("--json", arguments.json, "machine-readable result");
}

bool is_header(const std::filesystem::path& path) { return path.extension() == ".hpp"; }

// before the minute that it takes
void require_output(const Arguments& arguments) {
  const std::filesystem::path output = arguments.output;
  if (output.empty()) return;
  if (!is_header(output) && output.extension() != ".json") {
    throw std::runtime_error(output.string() + ": prices are written as .json or .hpp");
  }
  greenloop::CommandFiles files{.inputs = {}, .outputs = {{"the prices", output}}};
  for (const std::string& model : arguments.models) files.inputs.push_back({"a model", model});
  greenloop::require_writable(files);
}

void write(const std::string& output, const greenloop::Calibration& calibration) {
  greenloop::write_text_file(output, is_header(output)
                                         ? greenloop::prices_as_header(calibration.prices, calibration.unit)
                                         : greenloop::prices_as_json(calibration.prices, calibration.unit));
}

// `bytes` keeps what the models stand in
std::vector<greenloop::NamedModel> open_models(const std::vector<std::string>& names,
                                               std::list<greenloop::AlignedBytes>& bytes) {
  std::vector<greenloop::NamedModel> models;
  for (const std::string& name : names) {
    const auto opened = greenloop::Model::open(bytes.emplace_back(greenloop::load_file(name)).span());
    if (!opened) throw std::runtime_error(name + ": " + greenloop::describe(opened.result));
    greenloop::require_problem(opened.model.view(), greenloop::layout::Problem::elastostatic, name);
    models.push_back({name, opened.model});
  }
  return models;
}

std::vector<double> read_costs(const std::string& path) {
  std::ifstream file(path);
  std::vector<double> costs;
  for (double cost = 0; file >> cost;) {
    if (!(cost > 0)) throw std::runtime_error(fmt::format("{}: {} is no cost of a step", path, cost));
    costs.push_back(cost);
  }
  if (!file.eof()) throw std::runtime_error(fmt::format("{}: what follows cost {} is no number", path, costs.size()));
  return costs;
}

greenloop::Calibration calibrate(const std::vector<greenloop::NamedModel>& models, const Arguments& arguments) {
  const greenloop::CalibrationOptions& options = arguments.options;
  if (!arguments.costs.empty()) {
    return greenloop::calibrate(models, options, read_costs(arguments.costs), arguments.unit);
  }
  constexpr int repetitions = 7;
  const auto program = [] { return std::filesystem::read_symlink("/proc/self/exe").string(); };
  return greenloop::calibrate(models, options,
                              arguments.instructions
                                  ? greenloop::instruction_meter(program())
                                  : greenloop::time_meter(repetitions, greenloop::thread_stopwatch()));
}

// what is counted of this program by another, as instruction_meter asks for
void run_steps(const greenloop::NamedModel& model, const Arguments& arguments) {
  const greenloop::ScriptOptions options{
      .contacts = arguments.options.contacts, .cycles = arguments.options.cycles, .seed = arguments.options.seed};
  const greenloop::Prices prices = greenloop::read_prices(arguments.prices);
  (void)greenloop::run_steps(model.model, options, prices, greenloop::record_steps(model.model, options, prices));
}

void run(Arguments& arguments) {
  require_output(arguments);
  std::list<greenloop::AlignedBytes> bytes;
  const std::vector<greenloop::NamedModel> models = open_models(arguments.models, bytes);
  if (arguments.run_steps) {
    run_steps(models.at(0), arguments);
    return;
  }
  greenloop::offline::ProgressBar bar(arguments.json);
  std::string stage;
  arguments.options.progress = [&](const std::string& name, double share) {
    if (name != stage) bar.begin(stage = name);
    bar.update(share);
  };
  const greenloop::Calibration calibration = calibrate(models, arguments);
  bar.end();
  if (!arguments.output.empty()) write(arguments.output, calibration);
  if (arguments.json) {
    greenloop::print_result(greenloop::json_text(greenloop::as_json(calibration)) + "\n");
  } else {
    greenloop::print(calibration);
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Measures what the work of a step costs on this machine, in nanoseconds or instructions, and how well that "
      "predicts other steps.",
      "greenloop-calibrate");
  Arguments arguments;
  declare(app, arguments);
  return greenloop::run_program(app, argc, argv, [&] {
    run(arguments);
    return 0;
  });
}
