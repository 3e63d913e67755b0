#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "formats/output/json_text.hpp"
#include "formats/output/program.hpp"
#include "formats/output/streams.hpp"
#include "formats/write/model_file.hpp"
#include "offline/report/report.hpp"
#include "rt_tests/bench/contact_benchmark.hpp"
#include "rt_tests/bench/exact_columns.hpp"
#include "rt_tests/bench/field_benchmark.hpp"
#include "rt_tests/bench/kernel_benchmark.hpp"
#include "rt_tests/bench/multigrid_benchmark.hpp"
#include "rt_tests/bench/multigrid_figures.hpp"
#include "rt_tests/bench/roofline.hpp"
#include "rt_tests/bench/synthesis_benchmark.hpp"
#include "runtime/model.hpp"

namespace {

using greenloop::bench::BackSubstitution;
using greenloop::bench::CapacitanceFigures;
using greenloop::bench::ColourFigures;
using greenloop::bench::ContactFigures;
using greenloop::bench::CreationFigures;
using greenloop::bench::FieldFigures;
using greenloop::bench::ForceFigures;
using greenloop::bench::MultigridFigures;
using greenloop::bench::Roofline;
using greenloop::bench::RooflinePoint;
using greenloop::bench::SolverFigures;
using greenloop::bench::SynthesisFigures;
using greenloop::bench::TransformFigures;
using nlohmann::json;

struct Arguments {
  std::filesystem::path model, store;
  std::vector<std::size_t> contacts{1, 16, 64, 256};
  std::size_t rounds = 40;
  std::uint64_t updates = 10000;
  bool multigrid = false, alone = false;
  greenloop::bench::MultigridStudy study;
  std::optional<std::filesystem::path> figures;
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
          {"field_us", figures.field_us},
          {"step_us", figures.step_us},
          {"cold_step_us", figures.cold_step_us},
          {"fresh_step_us", figures.fresh_step_us},
          {"field_dense_ratio", figures.field_dense_ratio},
          {"dense_ratio", figures.dense_ratio},
          {"cold_dense_ratio", figures.cold_dense_ratio},
          {"same_set_dense_ratio", figures.same_set_dense_ratio},
          {"backsolve_ratio", figures.backsolve_ratio},
          {"rms_error", figures.rms_error},
          {"force_error", figures.force_error},
          {"total_force_error", figures.total_force_error},
          {"work", figures.work},
          {"rungs", rungs}};
}

// the parts of a step by themselves
struct KernelFigures {
  TransformFigures transform;
  std::vector<CapacitanceFigures> capacitance;
  std::vector<ForceFigures> forces;
};

KernelFigures measure_kernels(const greenloop::Model& model, const greenloop::GreenStore& store,
                              const Arguments& arguments) {
  KernelFigures figures{greenloop::bench::measure_transform(model, store, arguments.rounds), {}, {}};
  for (const std::size_t contacts : {16, 64}) {
    figures.capacitance.push_back(
        greenloop::bench::measure_capacitance(model, contacts, arguments.rounds, arguments.updates));
  }
  for (const std::size_t contacts : {1, 16, 64}) {
    figures.forces.push_back(greenloop::bench::measure_forces(model, contacts, arguments.rounds));
  }
  return figures;
}

json as_json(const CapacitanceFigures& figures) {
  return {{"contacts", figures.contacts},   {"extract_ns_per_block", figures.extract_ns_per_block},
          {"factor_us", figures.factor_us}, {"insert_us", figures.insert_us},
          {"remove_us", figures.remove_us}, {"updates", figures.updates},
          {"drift", figures.drift}};
}

json as_json(const ContactFigures& figures) {
  json result{{"contacts", figures.contacts}, {"friction", figures.friction},
              {"residual", figures.residual}, {"us", figures.us},
              {"worst_us", figures.worst_us}, {"cold_us", figures.cold_us},
              {"work", figures.work},         {"unfinished", figures.unfinished}};
  if (figures.siconos) {
    result["siconos_us"] = figures.siconos->us;
    result["siconos_solver"] = figures.siconos->solver;
    result["siconos_failed"] = figures.siconos->failed;
  }
  return result;
}

json as_json(const ForceFigures& figures) { return {{"contacts", figures.contacts}, {"us", figures.us}}; }

json as_json(const SynthesisFigures& figures) {
  return {{"rank", figures.rank},      {"planes", figures.planes},
          {"nodes", figures.vertices}, {"truncation_error", figures.error},
          {"us", figures.us},          {"frames_per_s", figures.frames_per_s},
          {"bytes", figures.bytes},    {"bandwidth_ratio", figures.bandwidth_ratio},
          {"work", figures.work}};
}

json as_json(const ColourFigures& figures) {
  return {{"rank", figures.rank},   {"us", figures.us},
          {"bytes", figures.bytes}, {"frames_per_s", figures.frames_per_s},
          {"work", figures.work},   {"bandwidth_ratio", figures.bandwidth_ratio}};
}

json as_json(const RooflinePoint& point) {
  return {{"kernel", point.kernel},
          {"contacts", point.contacts},
          {"bytes", point.bytes},
          {"flops", point.flops},
          {"us", point.us},
          {"gb_per_s", point.gb_per_s},
          {"bound_us", point.bound_us},
          {"ratio", point.ratio},
          {"compute_us", point.compute_us},
          {"compute_ratio", point.us / point.compute_us},
          {"bound_by", point.compute_bound() ? "arithmetic" : "bytes"}};
}

/// Seconds, or nothing of a solver that failed.
json seconds_of(const SolverFigures& figures) { return figures.reached ? json(figures.seconds()) : json(nullptr); }

json as_json(const MultigridFigures& f) {
  json result{{"problem", f.problem},
              {"tetrahedra", f.tetrahedra},
              {"unknowns", f.unknowns},
              {"contrast", f.contrast},
              {"poisson", f.poisson},
              {"levels", f.levels},
              {"memory_bytes", f.memory_bytes},
              {"setup_s", f.multigrid.setup_s},
              {"solve_s", f.multigrid.solve_s},
              {"iterations", f.multigrid.iterations},
              {"residual", f.multigrid.residual},
              {"reached", f.multigrid.reached},
              {"gamg_s", nullptr},
              {"diagonal_cg_s", nullptr}};
  if (f.diagonal) {
    result["diagonal_cg_s"] = seconds_of(*f.diagonal);
    result["diagonal_cg_iterations"] = f.diagonal->iterations;
  }
  if (f.gamg) {
    result["gamg_s"] = seconds_of(*f.gamg);
    result["gamg_setup_s"] = f.gamg->setup_s;
    result["gamg_solve_s"] = f.gamg->solve_s;
    result["gamg_iterations"] = f.gamg->iterations;
    result["gamg_residual"] = f.gamg->residual;
  }
  return result;
}

template <class Figures>
json list_of(const std::vector<Figures>& all) {
  json list = json::array();
  for (const auto& figures : all) {
    list.push_back(as_json(figures));
  }
  return list;
}

void print_kernels(const KernelFigures& kernels) {
  fmt::print("\nParts of a step, thread CPU time:\n");
  fmt::print("inverse transform {:.2f} us, one dense Green's function {:.2f} us: {:.2f}\n",
             kernels.transform.transform_us, kernels.transform.dense_column_us, kernels.transform.ratio);
  fmt::print("{:>8} {:>16} {:>11} {:>11} {:>11} {:>9} {:>9}\n", "contacts", "extract ns/block", "factor us",
             "insert us", "remove us", "updates", "drift");
  for (const auto& c : kernels.capacitance) {
    fmt::print("{:>8} {:>16.0f} {:>11.2f} {:>11.2f} {:>11.2f} {:>9} {:>9.1e}\n", c.contacts, c.extract_ns_per_block,
               c.factor_us, c.insert_us, c.remove_us, c.updates, c.drift);
  }
  for (const auto& f : kernels.forces) {
    fmt::print("forces of {} contacts alone, factor cached: {:.2f} us\n", f.contacts, f.us);
  }
}

std::vector<ContactFigures> measure_contacts(const greenloop::Model& model, const Arguments& arguments) {
  std::vector<ContactFigures> all;
  for (const std::size_t contacts : {16, 64}) {
    for (const float friction : {0.0F, 0.3F, 0.8F}) {
      all.push_back(greenloop::bench::measure_contacts(model, contacts, friction, arguments.rounds / 4 + 1));
    }
  }
  return all;
}

void print_contacts(const std::vector<ContactFigures>& all) {
  fmt::print("\nUnilateral contact with Coulomb friction, each step from the one before, thread CPU time:\n");
  fmt::print("{:>8} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>10} {:>11}\n", "contacts", "friction", "residual", "us",
             "worst us", "cold us", "work", "unfinished", "Siconos us");
  for (const auto& f : all) {
    fmt::print("{:>8} {:>9.2f} {:>9.1e} {:>9.1f} {:>9.1f} {:>9.1f} {:>9} {:>10} {:>11}\n", f.contacts, f.friction,
               f.residual, f.us, f.worst_us, f.cold_us, f.work, f.unfinished,
               f.siconos ? fmt::format("{:.0f} {}", f.siconos->us, f.siconos->solver) : "-");
  }
}

json streams_of(const Roofline& roofline) {
  json streams = json::array();
  for (std::size_t i = 0; i < roofline.gb_per_s.size(); ++i) {
    streams.push_back({{"bytes", greenloop::bench::stream_bytes[i]}, {"gb_per_s", roofline.gb_per_s[i]}});
  }
  return streams;
}

void print_roofline(const Roofline& roofline) {
  fmt::print("\nRoofline, one set over and over, thread CPU time. Reading");
  for (std::size_t i = 0; i < roofline.gb_per_s.size(); ++i) {
    fmt::print(" {} KB: {:.1f} GB/s,", greenloop::bench::stream_bytes[i] >> 10, roofline.gb_per_s[i]);
  }
  fmt::print(" arithmetic in fours: {:.1f} GFlop/s\n", roofline.gflops);
  fmt::print("{:<20} {:>8} {:>10} {:>12} {:>10} {:>6} {:>9} {:>7} {:>11} {:>7}  {}\n", "kernel", "contacts", "bytes",
             "flops", "us", "GB/s", "bound us", "ratio", "compute us", "ratio", "bound by");
  for (const RooflinePoint& p : roofline.points) {
    fmt::print("{:<20} {:>8} {:>10.0f} {:>12.0f} {:>10.2f} {:>6.1f} {:>9.2f} {:>7.2f} {:>11.2f} {:>7.2f}  {}\n",
               p.kernel, p.contacts, p.bytes, p.flops, p.us, p.gb_per_s, p.bound_us, p.ratio, p.compute_us,
               p.us / p.compute_us, p.compute_bound() ? "arithmetic" : "bytes");
  }
}

void print_table(const std::vector<FieldFigures>& all, const BackSubstitution& back) {
  fmt::print("one sparse back-substitution ({}): {:.0f} us\n\n", back.solver, 1e6 * back.seconds);
  fmt::print("{:>8} {:>9} {:>9} {:>9} {:>9} {:>9} {:>8} {:>8} {:>8} {:>8} {:>10} {:>8} {:>8} {:>9}\n", "contacts",
             "dense us", "field us", "step us", "cold us", "fresh us", "x field", "x step", "x cold", "same set",
             "x backsolve", "RMS", "force", "work");
  for (const auto& f : all) {
    fmt::print(
        "{:>8} {:>9.1f} {:>9.2f} {:>9.2f} {:>9.2f} {:>9.1f} {:>8.1f} {:>8.1f} {:>8.1f} {:>8.1f} {:>11.0f} {:>7.2f}% "
        "{:>7.2f}% {:>9}\n",
        f.contacts, f.dense_us, f.field_us, f.step_us, f.cold_step_us, f.fresh_step_us, f.field_dense_ratio,
        f.dense_ratio, f.cold_dense_ratio, f.same_set_dense_ratio, f.backsolve_ratio, 100 * f.rms_error,
        100 * f.force_error, f.work);
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

int run_motion(const Arguments& arguments, const greenloop::Model& model) {
  const auto figures = greenloop::bench::measure_motion(model, arguments.rounds);
  if (arguments.json) {
    const json colours = figures.colours ? as_json(*figures.colours) : json(nullptr);
    greenloop::print_result(greenloop::json_text(json{{"model", arguments.model.filename().string()},
                                                      {"state_us", figures.step_us},
                                                      {"state_work", figures.step_work},
                                                      {"synthesis", list_of(figures.synthesis)},
                                                      {"colours", colours}}) +
                            "\n");
    return 0;
  }
  fmt::print("a step without displacements: {:.3f} us, {} units\n\nDisplacements of all vertices, thread CPU time:\n",
             figures.step_us, figures.step_work);
  fmt::print("{:>6} {:>7} {:>9} {:>10} {:>9} {:>11} {:>16} {:>10}\n", "modes", "planes", "vertices", "truncation", "us",
             "frames/s", "x bytes/stream", "work");
  for (const SynthesisFigures& f : figures.synthesis) {
    fmt::print("{:>6} {:>7} {:>9} {:>9.2f}% {:>9.1f} {:>11.0f} {:>16.2f} {:>10}\n", f.rank, f.planes, f.vertices,
               100 * f.error, f.us, f.frames_per_s, f.bandwidth_ratio, f.work);
  }
  if (const auto& c = figures.colours) {
    fmt::print(
        "\nColours of all vertices by {} modes of light: {:.1f} us, {:.0f} frames/s, {:.2f} x bytes/stream, {} units\n",
        c->rank, c->us, c->frames_per_s, c->bandwidth_ratio, c->work);
  }
  return 0;
}

int run_contact(const Arguments& arguments, const greenloop::Model& model) {
  if (arguments.store.empty()) {
    throw std::runtime_error(arguments.model.string() +
                             ": name the HDF5 store that the model was built from with --store");
  }
  auto store = greenloop::GreenStore::open(arguments.store, greenloop::GreenStore::Access::kReadOnly);
  store.require_components(3);
  const auto back = greenloop::bench::time_back_substitution(store);
  std::vector<FieldFigures> all;
  for (const std::size_t contacts : arguments.contacts) {
    all.push_back(greenloop::bench::measure_field(model, store, contacts, arguments.rounds, back.seconds));
  }
  const KernelFigures kernels = measure_kernels(model, store, arguments);
  const Roofline roofline = greenloop::bench::measure_roofline(model, arguments.contacts, arguments.rounds);
  const std::vector<ContactFigures> contact = measure_contacts(model, arguments);
  const CreationFigures creation =
      greenloop::bench::measure_creation(model, {.max_contacts = model.view().info->max_contacts});
  if (!arguments.json) {
    print_table(all, back);
    print_kernels(kernels);
    print_roofline(roofline);
    print_contacts(contact);
    fmt::print("\na body of {} contacts and {} cached factors: arena {} bytes, created in {:.1f} ms\n",
               creation.limits.max_contacts, creation.limits.cached_factors, creation.arena_bytes, creation.create_ms);
    return 0;
  }
  greenloop::print_result(
      greenloop::json_text(json{{"model", arguments.model.filename().string()},
                                {"backsolve_us", 1e6 * back.seconds},
                                {"backsolve_solver", back.solver},
                                {"field", list_of(all)},
                                {"transform_us", kernels.transform.transform_us},
                                {"dense_column_us", kernels.transform.dense_column_us},
                                {"transform_over_dense_column", kernels.transform.ratio},
                                {"extract_ns_per_block", kernels.capacitance.back().extract_ns_per_block},
                                {"capacitance", list_of(kernels.capacitance)},
                                {"force_only", list_of(kernels.forces)},
                                {"contact", list_of(contact)},
                                {"create_ms", creation.create_ms},
                                {"arena_bytes", creation.arena_bytes},
                                {"streams", streams_of(roofline)},
                                {"gflops", roofline.gflops},
                                {"roofline", list_of(roofline.points)}}) +
      "\n");
  return 0;
}

std::string times_of(const std::optional<SolverFigures>& figures) {
  if (!figures) return "-";
  if (!figures->reached) return fmt::format("fails ({})", figures->iterations);
  return fmt::format("{:.3f} + {:.3f} ({})", figures->setup_s, figures->solve_s, figures->iterations);
}

/// How many times as long it takes.
std::string times_as_long(const std::optional<SolverFigures>& figures, const SolverFigures& ours) {
  return figures && figures->reached ? fmt::format("{:.1f}", figures->seconds() / ours.seconds()) : "-";
}

int run_multigrid(const Arguments& arguments) {
  greenloop::bench::MultigridStudy study = arguments.study;
  if (arguments.alone) study.peers = greenloop::bench::Peers::none;
  const std::vector<MultigridFigures> all = greenloop::bench::measure_multigrid(study);
  if (arguments.figures) {
    greenloop::offline::write_figures(*arguments.figures, {greenloop::bench::multigrid_figure(all)});
  }
  if (arguments.json) {
    greenloop::print_result(greenloop::json_text(json{{"multigrid", list_of(all)}}) + "\n");
    return 0;
  }
  fmt::print("Set-up s + solution s (iterations) to a true residual of 1e-5, thread CPU time\n");
  fmt::print("{:<26} {:>10} {:>8} {:>6} {:>23} {:>23} {:>8} {:>24} {:>8} {:>8}\n", "problem", "tetrahedra", "contrast",
             "nu", "multigrid", "PETSc CG + GAMG", "x", "diagonal CG", "x", "MB");
  for (const MultigridFigures& f : all) {
    fmt::print("{:<26} {:>10} {:>8.0e} {:>6} {:>23} {:>23} {:>8} {:>24} {:>8} {:>8.1f}\n", f.problem, f.tetrahedra,
               f.contrast, f.poisson, times_of(f.multigrid), times_of(f.gamg), times_as_long(f.gamg, f.multigrid),
               times_of(f.diagonal), times_as_long(f.diagonal, f.multigrid),
               1e-6 * static_cast<double>(f.memory_bytes));
  }
  return 0;
}

int run(const Arguments& arguments) {
  if (arguments.multigrid) return run_multigrid(arguments);
  const auto file = greenloop::open_model_file(arguments.model);
  const auto opened = greenloop::Model::open(file.bytes.span());
  if (opened.model.problem() == greenloop::layout::Problem::impulse_response) {
    return run_motion(arguments, opened.model);
  }
  greenloop::require_problem(file.view, greenloop::layout::Problem::elastostatic, arguments.model);
  return run_contact(arguments, opened.model);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Measures the field of given forces and a whole step (cached factor, forces, displacement of every node) against "
      "summing dense columns and against a sparse back-substitution, side by side in one run, and field and contact "
      "forces against the exact solution. Of an impulse response model: frames a second by as many modes as a budget "
      "holds. With --multigrid: elastic cubes by multigrid, PETSc's algebraic multigrid and diagonal conjugate "
      "gradients.",
      "greenloop-bench");
  Arguments arguments;
  app.add_option("model", arguments.model, "The model file")->check(CLI::ExistingFile);
  app.add_option("--store", arguments.store, "The HDF5 store an elastostatic model was built from")
      ->check(CLI::ExistingFile);
  app.add_option("--contacts", arguments.contacts, "Constraint counts to measure")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  app.add_option("--rounds", arguments.rounds, "Rounds per figure; medians are reported")
      ->check(CLI::Range(3, 100000))
      ->capture_default_str();
  app.add_option("--updates", arguments.updates, "Nodes that leave and enter a factor before its drift is measured")
      ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1} << 32))
      ->capture_default_str();
  app.add_flag("--multigrid", arguments.multigrid, "Measure multigrid, which needs no model");
  app.add_flag("--alone", arguments.alone, "Leave its peers out");
  app.add_option("--cells", arguments.study.cells, "Cells along an edge of the cubes that multigrid solves")
      ->check(CLI::Range(2, 96))
      ->capture_default_str();
  app.add_option("--contrasts", arguments.study.contrasts, "Of their stiff parts' moduli to the others'")
      ->check(CLI::Range(1.0, 1e12))
      ->capture_default_str();
  app.add_option("--figures", arguments.figures, "Folder to draw multigrid's curves to, as SVG");
  app.add_option("--netgen-cells", arguments.study.netgen_cells, "The same of cubes by Netgen, 0 for none")
      ->check(CLI::Range(0, 64))
      ->capture_default_str();
  app.add_flag("--json", arguments.json, "Print JSON");
  app.callback([&arguments] {
    if (arguments.model.empty() && !arguments.multigrid) throw CLI::RequiredError("model, or --multigrid");
  });
  return greenloop::run_program(app, argc, argv, [&] { return run(arguments); });
}
