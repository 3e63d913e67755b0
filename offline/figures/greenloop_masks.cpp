#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "formats/output/json_text.hpp"
#include "formats/output/output_paths.hpp"
#include "formats/output/program.hpp"
#include "formats/output/streams.hpp"
#include "offline/figures/mask_study.hpp"
#include "offline/pipeline/progress_bar.hpp"
#include "offline/report/report.hpp"

namespace {

using namespace greenloop::offline;
using nlohmann::json;

struct Arguments {
  int splits = 0;
  int sliding_splits = 3;
  double radius = 2;
  bool linear = false;
  double uneven = 0.3;
  unsigned seed = 1;
  double polar = 0.8;
  int points = 720;
  std::optional<std::filesystem::path> figures;
  bool json = false;
};

std::string change(double now, double before) {
  return before > 0 ? fmt::format("{:+.2f} %", 100 * (now / before - 1)) : "";
}

void print_table(const std::vector<RefinedStiffness>& rows) {
  fmt::print("stiffness in the middle of the top, N/m\n  {:>8} {:>8} {:>10} {:>14} {:>10} {:>10} {:>10}\n", "vertices",
             "edge mm", "single", "masked vertex", "change", "held mask", "change");
  RefinedStiffness last;
  for (const RefinedStiffness& row : rows) {
    fmt::print("  {:>8} {:>8.3f} {:>10.1f} {:>14.1f} {:>10} {:>10.1f} {:>10}\n", row.vertices, 1e3 * row.edge,
               row.single, row.masked, change(row.masked, last.masked), row.held, change(row.held, last.held));
    last = row;
  }
}

json as_json(const std::vector<RefinedStiffness>& rows) {
  json all = json::array();
  for (const RefinedStiffness& row : rows) {
    all.push_back({{"vertices", row.vertices},
                   {"edge", row.edge},
                   {"single", row.single},
                   {"masked", row.masked},
                   {"held", row.held}});
  }
  return all;
}

int run(const Arguments& arguments) {
  if (arguments.figures) greenloop::require_writable_folder(*arguments.figures);
  ProgressBar progress(arguments.json);
  const auto elements = arguments.linear ? greenloop::Elements::linear : greenloop::Elements::quadratic;
  progress.begin("refinements");
  const std::vector<RefinedStiffness> rows = refine_stiffness(
      arguments.splits, arguments.radius, elements,
      [&](int level) { progress.update((level - 1.0) / arguments.splits, fmt::format("split {} times", level)); });
  progress.end("");
  progress.begin("sliding");
  MaskedBody body(make_nodule({.splits = arguments.sliding_splits, .uneven = arguments.uneven, .seed = arguments.seed}),
                  elements);
  const double radius = 2 * mean_edge(body.nodule().surface);
  const SlidingForce force = slide_around(body, arguments.polar, radius, arguments.points);
  progress.end("");
  const double single = SlidingForce::ripple(force.single), masked = SlidingForce::ripple(force.masked);
  const double held = SlidingForce::ripple(force.held);
  if (arguments.json) {
    greenloop::print_result(
        greenloop::json_text(
            json{{"refinement", as_json(rows)},
                 {"ripple", {{"single", single}, {"masked", masked}, {"held", held}, {"radius", radius}}}}) +
        "\n");
  } else {
    print_table(rows);
    fmt::print(
        "sliding at constant depth around the axis, largest less smallest normal force over the mean, masks of {:.2f} "
        "mm\n  single vertices {:.1f} %, masked vertices {:.2f} %, held masks {:.2f} %\n",
        1e3 * radius, 100 * single, 100 * masked, 100 * held);
  }
  if (arguments.figures) write_figures(*arguments.figures, {masks_figure(body, radius, force)});
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Point-like contact with and without vertex pressure masks (James and Pai 2001, table 1 and figure 7) on a "
      "generated nodular body: the stiffness of one vertex as the body's triangulation is refined, and the ripple of "
      "the normal force of a point that slides over an uneven one.",
      "greenloop-masks");
  Arguments arguments;
  app.add_option("splits", arguments.splits, "Refinements, of 42, 162, 642, 2,562 and 10,242 vertices")
      ->required()
      ->check(CLI::Range(1, 5));
  app.add_option("--radius", arguments.radius, "Of the mask, in mean edges of the coarsest body")
      ->check(CLI::Range(0.1, 4.0))
      ->capture_default_str();
  app.add_flag("--linear", arguments.linear, "Linear elements instead of quadratic ones");
  app.add_option("--sliding-splits", arguments.sliding_splits, "Refinement of the body that is slid over")
      ->check(CLI::Range(1, 5))
      ->capture_default_str();
  app.add_option("--uneven", arguments.uneven, "Edge lengths by which its vertices are moved at random")
      ->check(CLI::Range(0.0, 0.4))
      ->capture_default_str();
  app.add_option("--seed", arguments.seed, "Of these motions")->capture_default_str();
  app.add_option("--polar", arguments.polar, "Where it is slid, rad from the axis")
      ->check(CLI::Range(0.1, 1.4))
      ->capture_default_str();
  app.add_option("--points", arguments.points, "Points on the way around")
      ->check(CLI::Range(8, 100000))
      ->capture_default_str();
  app.add_option("--figures", arguments.figures, "Folder to write the picture to, as SVG");
  app.add_flag("--json", arguments.json, "Print JSON");
  return greenloop::run_program(app, argc, argv, [&] { return run(arguments); });
}
