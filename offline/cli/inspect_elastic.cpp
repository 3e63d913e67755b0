#include "offline/cli/inspect_elastic.hpp"

#include <fmt/format.h>
#include <fmt/ostream.h>

#include <cstdint>
#include <string>
#include <string_view>

#include "formats/write/aligned_bytes.hpp"
#include "formats/write/describe.hpp"
#include "runtime/multigrid.hpp"

namespace greenloop::offline {
namespace {

using Json = nlohmann::ordered_json;

std::string strain_name(std::uint32_t strain) {
  constexpr const char* names[] = {"linear", "corotational", "green"};
  return names[strain];
}

/// Bytes of a grid's sections.
std::uint64_t bytes_of(const GridView& grid) {
  constexpr std::uint64_t block = 12 * sizeof(float), word = sizeof(std::uint32_t);
  return grid.columns.size() * (block + word) + std::uint64_t{grid.vertices} * (block + 3 * word) + 2 * word +
         grid.parents.size() * 2 * word;
}

/// Finest first; tetrahedra are the finest grid's alone.
Json levels_of(const MultigridView& view) {
  Json levels = Json::array();
  for (std::uint32_t g = 0; g + 1 < view.info->grids; ++g) {
    levels.push_back({{"nodes", view.grid[g].vertices},
                      {"tetrahedra", g == 0 ? Json(view.info->tetrahedra) : Json(nullptr)},
                      {"blocks", view.grid[g].columns.size()},
                      {"bytes", bytes_of(view.grid[g])}});
  }
  levels.push_back({{"nodes", view.info->coarsest_vertices},
                    {"tetrahedra", view.info->grids == 1 ? Json(view.info->tetrahedra) : Json(nullptr)},
                    {"blocks", nullptr},
                    {"bytes", view.coarsest_factor.size_bytes()}});
  return levels;
}

Json matters_of(const MultigridView& view) {
  Json matters = Json::array();
  for (std::uint32_t i = 0; i < view.info->matters; ++i) {
    const layout::MatterRecord& matter = view.matters[i];
    matters.push_back({{"lambda", matter.lambda}, {"mu", matter.mu}, {"density", matter.density}});
  }
  return matters;
}

/// That the first step from rest under the body's weight takes, within the tolerance or as far as rounding lets it.
std::uint32_t cycles_of(const Model& model) {
  constexpr std::uint64_t most_cycles = 50;
  constexpr Multigrid::Limits limits{.max_loads = 0, .max_holds = 0};
  const Multigrid::Requirement need = Multigrid::required(model, limits);
  AlignedBytes memory(need.bytes);
  Multigrid body = Multigrid::create(model, limits, {memory.data(), memory.size()}).body;
  return body.step({}, {need.least_work + most_cycles * need.cycle_work}, {}).cycles;
}

}  // namespace

Json elastic_inspection(const ModelFile& model, const Json& provenance) {
  const MultigridView& view = model.view.multigrid;
  const layout::MultigridInfo& info = *view.info;
  const Model opened = Model::open(model.bytes.span()).model;
  const Multigrid::Requirement need = Multigrid::required(opened, {});
  return {{"kind", "multigrid"},
          {"version", fmt::format("{}.{}", model.view.header->major, model.view.header->minor)},
          {"problem", problem_name(model.view.problem)},
          {"strain", strain_name(info.strain)},
          {"vertices", info.vertices},
          {"free_vertices", info.free},
          {"tetrahedra", info.tetrahedra},
          {"shown_vertices", info.shown},
          {"matters", matters_of(view)},
          {"levels", levels_of(view)},
          {"bytes", model.bytes.size()},
          {"time_step", info.time_step},
          {"mass_damping", info.mass_damping},
          {"stiffness_damping", info.stiffness_damping},
          {"numerical_damping", info.numerical_damping},
          {"gravity", info.gravity},
          {"arena_bytes", need.bytes},
          {"cycles", cycles_of(opened)},
          {"step_work",
           {{"least", need.least_work},
            {"cycle", need.cycle_work},
            {"shown", need.shown_work},
            {"stress", need.stress_work}}},
          {"provenance", provenance}};
}

void print_elastic_table(const std::filesystem::path& file, const Json& found, std::ostream& out) {
  const auto row = [&](std::string_view name, const std::string& value) {
    fmt::print(out, "  {:<20}{}\n", name, value);
  };
  fmt::print(out, "{}  (format {})\n", file.string(), found["version"].get<std::string>());
  row("problem", found["problem"].get<std::string>());
  row("body", fmt::format("{} tetrahedra, {} vertices, {} of them free, {} materials", found["tetrahedra"].dump(),
                          found["vertices"].dump(), found["free_vertices"].dump(), found["matters"].size()));
  row("strain", found["strain"].get<std::string>());
  row("shown", fmt::format("{} vertices", found["shown_vertices"].dump()));
  row("time step", fmt::format("{:.4g} s", found["time_step"].get<double>()));
  row("damping",
      fmt::format("mass {:.3g} 1/s, stiffness {:.3g} s, numerical {:.3g}", found["mass_damping"].get<double>(),
                  found["stiffness_damping"].get<double>(), found["numerical_damping"].get<double>()));
  const Json& work = found["step_work"];
  row("step",
      fmt::format("at least {} units, {} for each cycle more; the first one under its weight takes {} "
                  "cycles; arena {} bytes",
                  work["least"].dump(), work["cycle"].dump(), found["cycles"].dump(), found["arena_bytes"].dump()));
  row("bytes", found["bytes"].dump());
  fmt::print(out, "\n  {:<8}{:>10}{:>12}{:>12}{:>12}\n", "grid", "vertices", "tetrahedra", "blocks", "bytes");
  std::size_t g = 0;
  for (const Json& level : found["levels"]) {
    const auto text = [&](const char* key) { return level[key].is_null() ? std::string("-") : level[key].dump(); };
    fmt::print(out, "  {:<8}{:>10}{:>12}{:>12}{:>12}\n", g++, text("nodes"), text("tetrahedra"), text("blocks"),
               text("bytes"));
  }
}

}  // namespace greenloop::offline
