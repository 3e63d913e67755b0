#include "offline/report/report_command.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "formats/output/json_text.hpp"
#include "formats/output/output_file.hpp"
#include "formats/output/output_paths.hpp"
#include "formats/output/streams.hpp"
#include "formats/write/model_file.hpp"
#include "offline/report/axis.hpp"
#include "offline/report/elastic_report.hpp"
#include "offline/report/motion_report.hpp"
#include "offline/report/report.hpp"

namespace greenloop::offline {
namespace {

struct Options {
  std::string model, output, snapshot, build, stability, figures;
  std::vector<std::string> traces;
  bool provenance = false, json = false;
  std::optional<double> mask;
};

std::optional<std::filesystem::path> given(const std::string& path) {
  return path.empty() ? std::nullopt : std::optional<std::filesystem::path>(path);
}

void print_json(const std::string& output, const Report& report) {
  nlohmann::ordered_json root{{"report", output}, {"bytes", report.html.size()}};
  root["figures"] = nlohmann::ordered_json::array();
  for (const Figure& figure : report.figures) root["figures"].push_back(figure.name);
  root["missing"] = nlohmann::ordered_json::array();
  for (const MissingInput& input : report.missing) {
    root["missing"].push_back({{"what", input.what}, {"command", input.command}});
  }
  print_result(json_text(root) + "\n");
}

void print_text(const std::string& output, const Report& report) {
  print_result(fmt::format("{}: {} figures, {}\n", output, report.figures.size(),
                           readable_bytes(static_cast<double>(report.html.size()))));
  for (const MissingInput& input : report.missing) print_result("  not in it: " + input.what + "\n");
}

CommandFiles files_of(const Options& options, const std::string& output) {
  CommandFiles files{.inputs = {{"the model", options.model}}, .outputs = {{"the report", output}}};
  for (const std::string& trace : options.traces) files.inputs.push_back({"the trace", trace});
  for (const auto& [what, path] :
       {std::pair("the snapshot", options.snapshot), std::pair("the record of the build", options.build),
        std::pair("the stability map", options.stability)}) {
    if (!path.empty()) files.inputs.push_back({what, path});
  }
  return files;
}

void write_report(const Options& options, CommandFiles files, const Report& report) {
  for (const Figure& figure : report.figures) {
    if (!options.figures.empty()) files.outputs.push_back({"a figure", figure_path(options.figures, figure)});
  }
  if (!options.figures.empty()) std::filesystem::create_directories(options.figures);
  require_writable(files);
  write_text_file(files.outputs.front().path, report.html);
  if (!options.figures.empty()) write_figures(options.figures, report.figures);
}

Report report_of(const ModelFile& file, const ReportInputs& inputs) {
  if (file.view.problem == layout::Problem::impulse_response) return make_motion_report(file, inputs);
  if (file.view.problem == layout::Problem::multigrid) return make_elastic_report(file, inputs);
  return make_report(file, inputs);
}

void run(const Options& options) {
  const std::string output = options.output.empty()
                                 ? std::filesystem::path(options.model).replace_extension(".html").string()
                                 : options.output;
  const CommandFiles files = files_of(options, output);
  require_writable(files);
  if (!options.figures.empty()) require_writable_folder(options.figures);
  const ModelFile file = open_model_file(options.model);
  const std::string first = options.traces.empty() ? "" : options.traces.front();
  const auto more = options.traces.begin() + (options.traces.empty() ? 0 : 1);
  const ReportInputs inputs{.model = options.model,
                            .trace = given(first),
                            .snapshot = given(options.snapshot),
                            .build = given(options.build),
                            .more_traces = {more, options.traces.end()},
                            .stability = given(options.stability),
                            .provenance = options.provenance,
                            .mask = options.mask};
  const Report report = report_of(file, inputs);
  write_report(options, files, report);
  options.json ? print_json(output, report) : print_text(output, report);
}

}  // namespace

void add_report(CLI::App& parent, int& exit_code) {
  const auto options = std::make_shared<Options>();
  CLI::App* command =
      parent.add_subcommand("report", "Write pictures and figures of a model and of a run as one HTML file");
  command->add_option("model", options->model, "Model file (.gloop)")->required();
  command->add_option("-o,--output", options->output, "Report to write (default: the model's name with .html)");
  command
      ->add_option("--trace", options->traces,
                   "Cycles of a run, by greenloop-loop --trace; more of them: forces of other runs")
      ->allow_extra_args(false);
  command->add_option("--snapshot", options->snapshot,
                      "Displacements at the largest force, by greenloop-loop --snapshot");
  command->add_option("--stability", options->stability, "Stability of a loop, by greenloop-loop --stability");
  command->add_option("--build", options->build, "Record of the build, by greenloop build");
  command->add_option("--figures", options->figures, "Folder for each figure as its own SVG file");
  command
      ->add_option("--mask", options->mask, "Show the stiffness of every touchable node under masks of this radius, m")
      ->check(CLI::PositiveNumber);
  command->add_flag("--provenance", options->provenance, "Show how the model was built as well");
  command->add_flag("--json", options->json, "Print what was written as JSON");
  command->callback([options, &exit_code] {
    run(*options);
    exit_code = 0;
  });
}

}  // namespace greenloop::offline
