#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <vector>

#include "formats/model_file.hpp"
#include "rt_tests/bench/exact_columns.hpp"
#include "rt_tests/bench/field_benchmark.hpp"
#include "runtime/model.hpp"

namespace {

using greenloop::bench::BackSubstitution;
using greenloop::bench::FieldFigures;
using nlohmann::json;

struct Arguments {
  std::filesystem::path model, store;
  std::vector<std::size_t> contacts{1, 4, 16, 64};
  std::size_t rounds = 40;
  bool json = false;
};

json as_json(const FieldFigures& figures) {
  json rungs = json::array();
  for (const auto& rung : figures.rungs) {
    rungs.push_back({{"constraint_level", rung.constraint_level},
                     {"field_level", rung.field_level},
                     {"work", rung.work},
                     {"step_us", rung.step_us},
                     {"rms_error", rung.rms_error},
                     {"force_error", rung.force_error}});
  }
  return {{"contacts", figures.contacts},
          {"sets", figures.sets},
          {"dense_us", figures.dense_us},
          {"step_us", figures.step_us},
          {"fresh_step_us", figures.fresh_step_us},
          {"dense_ratio", figures.dense_ratio},
          {"same_set_dense_ratio", figures.same_set_dense_ratio},
          {"backsolve_ratio", figures.backsolve_ratio},
          {"rms_error", figures.rms_error},
          {"force_error", figures.force_error},
          {"total_force_error", figures.total_force_error},
          {"work", figures.work},
          {"rungs", rungs}};
}

void print_table(const std::vector<FieldFigures>& all, const BackSubstitution& back) {
  fmt::print("one sparse back-substitution ({}): {:.0f} us\n\n", back.solver, 1e6 * back.seconds);
  fmt::print("{:>8} {:>10} {:>10} {:>10} {:>9} {:>9} {:>10} {:>9} {:>9} {:>9}\n", "contacts", "dense us", "step us",
             "fresh us", "x dense", "same set", "x backsolve", "RMS", "force", "work");
  for (const auto& f : all) {
    fmt::print("{:>8} {:>10.1f} {:>10.2f} {:>10.1f} {:>9.1f} {:>9.1f} {:>10.0f} {:>8.2f}% {:>8.2f}% {:>9}\n",
               f.contacts, f.dense_us, f.step_us, f.fresh_step_us, f.dense_ratio, f.same_set_dense_ratio,
               f.backsolve_ratio, 100 * f.rms_error, 100 * f.force_error, f.work);
  }
  fmt::print("\nSpeed against error, as the budget shrinks (factor cached):\n");
  fmt::print("{:>8} {:>10} {:>11} {:>9} {:>10} {:>9} {:>9}\n", "contacts", "constraint", "field level", "work",
             "step us", "RMS", "force");
  for (const auto& f : all) {
    for (const auto& rung : f.rungs) {
      fmt::print("{:>8} {:>10} {:>11} {:>9} {:>10.2f} {:>8.2f}% {:>8.2f}%\n", f.contacts, rung.constraint_level,
                 rung.field_level, rung.work, rung.step_us, 100 * rung.rms_error, 100 * rung.force_error);
    }
  }
}

int run(const Arguments& arguments) {
  const auto file = greenloop::open_model_file(arguments.model);
  const auto opened = greenloop::Model::open(file.bytes.span());
  auto store = greenloop::GreenStore::open(arguments.store, greenloop::GreenStore::Access::kReadOnly);
  const auto back = greenloop::bench::time_back_substitution(store);
  std::vector<FieldFigures> all;
  for (const std::size_t contacts : arguments.contacts) {
    all.push_back(greenloop::bench::measure_field(opened.model, store, contacts, arguments.rounds, back.seconds));
  }
  if (!arguments.json) {
    print_table(all, back);
    return 0;
  }
  json field = json::array();
  for (const auto& figures : all) {
    field.push_back(as_json(figures));
  }
  fmt::print("{}\n", json{{"model", arguments.model.filename().string()},
                          {"backsolve_us", 1e6 * back.seconds},
                          {"backsolve_solver", back.solver},
                          {"field", field}}
                         .dump(2));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Measures a whole step (cached factor, forces, displacement of every node) against summing dense columns and "
      "against a sparse back-substitution, side by side in one run, and field and contact forces against the exact "
      "solution.",
      "greenloop-bench");
  Arguments arguments;
  app.add_option("model", arguments.model, "The model file")->required()->check(CLI::ExistingFile);
  app.add_option("--store", arguments.store, "The HDF5 store the model was built from")
      ->required()
      ->check(CLI::ExistingFile);
  app.add_option("--contacts", arguments.contacts, "Contact counts to measure")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  app.add_option("--rounds", arguments.rounds, "Rounds per figure; medians are reported")
      ->check(CLI::Range(3, 100000))
      ->capture_default_str();
  app.add_flag("--json", arguments.json, "Print JSON");
  CLI11_PARSE(app, argc, argv);
  try {
    return run(arguments);
  } catch (const std::exception& error) {
    fmt::print(stderr, "greenloop-bench: {}\n", error.what());
    return 1;
  }
}
