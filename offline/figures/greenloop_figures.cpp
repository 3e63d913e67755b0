#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "formats/output/json_text.hpp"
#include "formats/output/output_paths.hpp"
#include "formats/output/program.hpp"
#include "formats/output/streams.hpp"
#include "offline/figures/comparison.hpp"
#include "offline/figures/comparison_figures.hpp"
#include "offline/pipeline/progress_bar.hpp"
#include "offline/report/report.hpp"

namespace {

using namespace greenloop::offline;
using nlohmann::json;

struct Arguments {
  std::vector<std::filesystem::path> stores;
  std::optional<std::filesystem::path> figures;
  ComparisonPlan plan;
  bool json = false;
};

json as_json(const std::vector<RatePoint>& points) {
  json all = json::array();
  for (const RatePoint& point : points) {
    all.push_back({{"threshold", point.threshold},
                   {"ratio", point.ratio},
                   {"bytes", point.bytes},
                   {"rms_error", point.rms},
                   {"max_error", point.worst_column},
                   {"worst_patch_force_error", std::min(point.patch_force, 1e9)}});
  }
  return all;
}

json as_json(const std::vector<LevelRates>& levels) {
  json all = json::array();
  for (const LevelRates& level : levels) {
    all.push_back({{"level", level.level}, {"columns", level.columns}, {"points", as_json(level.points)}});
  }
  return all;
}

json as_json(const LineFit& fit) {
  return {{"intercept", fit.intercept}, {"slope", fit.slope}, {"r_squared", fit.r_squared}};
}

json as_json(const BodyComparison& body) {
  json forms = json::array(), quanta = json::array(), summation = json::array();
  for (const FormRates& form : body.forms) {
    forms.push_back(
        {{"wavelet", form.wavelet}, {"one_sided", as_json(form.column)}, {"two_sided", as_json(form.two_sided)}});
  }
  for (const QuantumRates& quantum : body.quanta) {
    quanta.push_back({{"quantum", quantum.quantum}, {"points", as_json(quantum.points)}});
  }
  for (const SummationPoint& point : body.summation) {
    summation.push_back({{"blocks", point.blocks}, {"work", point.work}, {"seconds", point.seconds}});
  }
  const SummationFit fit = fit_summation(body.summation);
  return {
      {"body", body.name},
      {"free_nodes", body.rows},
      {"forms", forms},
      {"quanta", quanta},
      {"summation", {{"points", summation}, {"work_fit", as_json(fit.work)}, {"seconds_fit", as_json(fit.seconds)}}}};
}

json as_json(const std::vector<Growth>& steps) {
  json all = json::array();
  for (const Growth& step : steps) {
    all.push_back({{"from", step.from}, {"to", step.to}, {"rms_error", step.rms}});
    if (step.column) all.back()["one_sided"] = *step.column;
    if (step.two_sided) all.back()["two_sided"] = *step.two_sided;
  }
  return all;
}

std::string percent(double value) { return value < 1e9 ? fmt::format("{:.3g} %", 100 * value) : "indefinite"; }

std::string number(const std::optional<double>& value) { return value ? fmt::format("{:.3g}", *value) : "-"; }

void print_points(const std::string& title, const std::vector<RatePoint>& points) {
  fmt::print("\n  {}\n  {:>10} {:>10} {:>12} {:>10} {:>10} {:>12}\n", title, "threshold", "x fewer", "bytes", "RMS",
             "MAX", "patch force");
  for (const RatePoint& point : points) {
    fmt::print("  {:>10} {:>10.1f} {:>12} {:>10} {:>10} {:>12}\n", point.threshold, point.ratio,
               point.bytes > 0 ? fmt::format("{:.0f}", point.bytes) : "", percent(point.rms),
               percent(point.worst_column), percent(point.patch_force));
  }
}

void print_levels(const std::string& title, const std::vector<LevelRates>& levels) {
  fmt::print("\n  {}: times fewer blocks, RMS error\n  {:>10}", title, "threshold");
  for (const LevelRates& level : levels) fmt::print(" {:>20}", fmt::format("level {}", level.level));
  fmt::print("\n");
  for (std::size_t t = 0; t < levels.front().points.size(); ++t) {
    fmt::print("  {:>10}", levels.front().points[t].threshold);
    for (const LevelRates& level : levels) {
      const RatePoint& point = level.points[t];
      fmt::print(" {:>20}", fmt::format("{:.1f}, {}", point.ratio, percent(point.rms)));
    }
    fmt::print("\n");
  }
}

void print_quanta(const BodyComparison& body) {
  fmt::print("\n  quantum over threshold: bytes at 5 % and at 20 % patch force error\n");
  for (const QuantumRates& quantum : body.quanta) {
    const auto bytes = [&](double error) {
      return interpolate(quantum.points, &RatePoint::patch_force, error, &RatePoint::bytes);
    };
    fmt::print("  {:>10} {:>12} {:>12}\n", quantum.quantum, number(bytes(0.05)), number(bytes(0.2)));
  }
}

void print_summation(const BodyComparison& body, std::size_t contacts) {
  fmt::print("\n  step of {} contacts, factor cached, whole field\n  {:>10} {:>12} {:>10}\n", contacts, "blocks",
             "work", "us");
  for (const SummationPoint& point : body.summation) {
    fmt::print("  {:>10.0f} {:>12.0f} {:>10.1f}\n", point.blocks, point.work, 1e6 * point.seconds);
  }
  const SummationFit fit = fit_summation(body.summation);
  fmt::print("  work = {:.4g} + {:.4g} blocks, r^2 = {:.5f}; us = {:.4g} + {:.4g} blocks, r^2 = {:.5f}\n",
             fit.work.intercept, fit.work.slope, fit.work.r_squared, 1e6 * fit.seconds.intercept,
             1e6 * fit.seconds.slope, fit.seconds.r_squared);
}

void print_body(const BodyComparison& body, std::size_t contacts) {
  fmt::print("{}: {} free nodes, {} constraint levels\n", body.name, body.rows, body.forms.back().column.size());
  for (const FormRates& form : body.forms) {
    print_points("one-sided, " + form.wavelet, form.column.back().points);
    print_points("two-sided, " + form.wavelet, form.two_sided.back().points);
  }
  print_levels("one-sided, " + body.forms.back().wavelet, body.forms.back().column);
  print_levels("two-sided, " + body.forms.back().wavelet, body.forms.back().two_sided);
  print_quanta(body);
  print_summation(body, contacts);
  fmt::print("\n");
}

void print_growth(const std::vector<Growth>& steps) {
  if (steps.empty()) return;
  fmt::print("growth of compression at equal RMS error\n  {:<16} {:<16} {:>8} {:>10} {:>10}\n", "from", "to", "RMS",
             "one-sided", "two-sided");
  for (const Growth& step : steps) {
    fmt::print("  {:<16} {:<16} {:>8} {:>10} {:>10}\n", step.from, step.to, percent(step.rms), number(step.column),
               number(step.two_sided));
  }
}

void draw(const std::vector<BodyComparison>& bodies, const std::filesystem::path& folder) {
  std::vector<Figure> figures;
  for (const BodyComparison& body : bodies) {
    for (auto draw_one : {error_over_ratio, error_over_threshold, level_errors_over_ratio, summation_cost}) {
      figures.push_back(draw_one(body));
    }
  }
  if (bodies.size() > 1) figures.push_back(growth_figure(bodies));
  write_figures(folder, figures);
}

int run(const Arguments& arguments) {
  if (arguments.figures) greenloop::require_writable_folder(*arguments.figures);
  std::vector<BodyComparison> bodies;
  json all = json::array();
  ProgressBar progress(arguments.json);
  const Progress report = [&](double fraction, std::string_view stage) { progress.update(fraction, stage); };
  for (const auto& store : arguments.stores) {
    progress.begin(store.stem().string());
    bodies.push_back(compare_forms(open_body(store), arguments.plan, report));
    progress.end(fmt::format("{} free nodes", bodies.back().rows));
    if (arguments.json) {
      all.push_back(as_json(bodies.back()));
    } else {
      print_body(bodies.back(), arguments.plan.contacts);
    }
  }
  if (arguments.json) {
    greenloop::print_result(greenloop::json_text(json{{"bodies", all}, {"growth", as_json(growth(bodies))}}) + "\n");
  } else {
    print_growth(growth(bodies));
  }
  if (arguments.figures) draw(bodies, *arguments.figures);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Measures the one-sided compression of James and Pai 2003 beside Greenloop's on exact Green's functions: errors "
      "against compression and threshold with each wavelet on each constraint level, quanta, the cost of a step "
      "against blocks summed, and, of several bodies, the growth of compression with their size.",
      "greenloop-figures");
  Arguments arguments;
  app.add_option("stores", arguments.stores, "HDF5 stores that `greenloop build` wrote, one per body")
      ->required()
      ->check(CLI::ExistingFile);
  app.add_option("--figures", arguments.figures, "Folder to write every picture to, as SVG");
  app.add_option("--epsilon", arguments.plan.column_thresholds, "Thresholds of the one-sided form, increasing")
      ->check(CLI::Range(1e-6, 1.0))
      ->capture_default_str();
  app.add_option("--tau", arguments.plan.two_sided_thresholds, "Thresholds of the two-sided form, increasing")
      ->check(CLI::Range(1e-4, 1.0))
      ->capture_default_str();
  app.add_option("--quanta", arguments.plan.quanta, "Quanta to compare, relative to the threshold")
      ->check(CLI::Range(0.01, 2.0))
      ->capture_default_str();
  app.add_option("--contacts", arguments.plan.contacts, "Contacts of the timed step")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  app.add_option("--rounds", arguments.plan.rounds, "Rounds per time; medians are reported")
      ->check(CLI::Range(3, 100000))
      ->capture_default_str();
  app.add_flag("--json", arguments.json, "Print JSON");
  return greenloop::run_program(app, argc, argv, [&] { return run(arguments); });
}
