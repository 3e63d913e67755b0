#include "offline/cli/inspect_command.hpp"

#include <fmt/format.h>
#include <fmt/ostream.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cstring>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <string>

#include "formats/output/json_text.hpp"
#include "formats/output/streams.hpp"
#include "formats/stored_blocks.hpp"
#include "formats/write/describe.hpp"
#include "formats/write/model_file.hpp"
#include "offline/cli/inspect_budget.hpp"
#include "offline/cli/inspect_elastic.hpp"
#include "offline/cli/inspect_motion.hpp"
#include "offline/cli/inspect_patterns.hpp"
#include "offline/compress/measure/field_size.hpp"
#include "offline/pipeline/model_quality.hpp"

namespace greenloop::offline {
namespace {

using Json = nlohmann::ordered_json;

Json sections_of(const ModelFile& model) {
  Json sections = Json::array();
  const std::byte* next = model.bytes.data() + sizeof(layout::Header);
  for (std::uint32_t i = 0; i < model.view.header->section_count; ++i, next += sizeof(layout::SectionEntry)) {
    layout::SectionEntry entry;
    std::memcpy(&entry, next, sizeof(entry));
    sections.push_back({{"kind", section_name(static_cast<layout::SectionKind>(entry.kind), entry.a, entry.b)},
                        {"a", entry.a},
                        {"b", entry.b},
                        {"offset", entry.offset},
                        {"bytes", entry.bytes}});
  }
  return sections;
}

// of the sections that a loop would otherwise make at its start
std::uint64_t ready_bytes(const ModelView& view) {
  std::uint64_t bytes = 0;
  for (const layout::SectionEntry& entry : section_entries(view)) {
    const bool is_ready = layout::is_ready_kind(static_cast<layout::SectionKind>(entry.kind));
    bytes += is_ready ? layout::aligned(entry.bytes) + sizeof(entry) : 0;
  }
  return bytes;
}

Json levels_of(const ModelView& view) {
  Json levels = Json::array();
  for (std::uint32_t c = view.info->coarsest_constraint_level; c < view.levels; ++c) {
    const layout::Level& level = *view.level[c].counts;
    const std::uint32_t columns = view.level[c].domain_begin + level.domain_count;
    levels.push_back({{"level", c},
                      {"columns", columns},
                      {"kept_blocks", level.kept_blocks},
                      {"dense_blocks", level.dense_blocks},
                      {"rms_error", level.rms_error},
                      {"worst_column_error", level.worst_column_error},
                      {"worst_patch_force_error", level.patch_force_error},
                      {"field_rms_error", level.field_rms_error},
                      {"field_column_error", level.field_column_error},
                      {"field_error", level.field_error},
                      {"field_peak", level.field_peak},
                      {"force_error", level.force_error},
                      {"cut_error", level.cut_error},
                      {"field_blocks", 2 * level.kept_blocks - columns}});
  }
  return levels;
}

Json provenance_of(const ModelView& view) {
  const std::string text(view.provenance.begin(), view.provenance.end());
  const Json parsed = Json::parse(text, nullptr, false);
  return parsed.is_discarded() ? Json(text) : parsed;
}

// couplings by the bits of their values
Json bits_of(const ModelView& view) {
  std::map<std::uint32_t, std::uint64_t> blocks;
  for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
    const std::uint64_t count = block_count(view, layer, layer + 1);
    if (count > 0) blocks[layout::value_bits[layer]] += count;
  }
  Json bits = Json::object();
  for (const auto& [width, count] : blocks) bits[std::to_string(width)] = count;
  return bits;
}

// what the build recorded of its search, if the model is its work
Json recorded(const ModelView& view, const std::string& key, const Json& otherwise) {
  const Json provenance = provenance_of(view);
  return provenance.is_object() && provenance.contains(key) ? provenance[key] : otherwise;
}

// what a body of the loop sums for a field, if there are bodies of such models
Json field_size_of(const ModelView& view) {
  if (view.problem != layout::Problem::elastostatic) return {{"blocks", nullptr}, {"longest", nullptr}};
  const FieldSize field = field_size(view);
  return {{"blocks", field.blocks}, {"longest", field.longest}};
}

// of an elastostatic model only
Json material_of(const ModelView& view) {
  if (view.problem != layout::Problem::elastostatic) return nullptr;
  return {{"young", view.info->young}, {"poisson", view.info->poisson}};
}

// those of a scalar problem's quantity are not in the file
Json units_of(const ModelView& view) {
  const auto mechanical = [&](const char* unit) {
    return view.problem == layout::Problem::elastostatic ? Json(unit) : Json(nullptr);
  };
  return {{"length", "m"},
          {"area", "m^2"},
          {"force", mechanical("N")},
          {"compliance", mechanical("m/N")},
          {"young", mechanical("Pa")},
          {"rate", "Hz"},
          {"step_work", "work units"}};
}

Json quality_here(const ModelView& view, const Json& budget) {
  const auto number = [&](const char* key) {
    return budget[key].is_number() ? std::optional(budget[key].get<double>()) : std::nullopt;
  };
  const bool is_known = budget["arena_bytes"].is_number();
  return quality_of(view,
                    {.arena_bytes = is_known ? std::optional(budget["arena_bytes"].get<std::uint64_t>()) : std::nullopt,
                     .us = number("us"),
                     .asked_us = number("share_us"),
                     .speed = "on this machine"});
}

Json loads_of(const ModelView& view) {
  Json loads = Json::array();
  for (const layout::LoadRecord& load : view.loads) {
    loads.push_back({{"name", load_name(load)}, {"unit", load_unit(load.kind)}, {"resultant", load.resultant}});
  }
  return loads;
}

Json inspection_of(const ModelFile& model) {
  const ModelView& view = model.view;
  const layout::Info& info = *view.info;
  const layout::Level& finest = *view.level[view.levels - 1].counts;
  const Json field = field_size_of(view), budget = budget_of(model), quality = quality_here(view, budget);
  const std::uint64_t block_bytes = std::uint64_t{info.components} * info.components * sizeof(float);
  return {
      {"verdict", quality["verdict"]},
      {"quality", quality},
      {"version", fmt::format("{}.{}", view.header->major, view.header->minor)},
      {"problem", problem_name(view.problem)},
      {"nodes", view.node_count},
      {"domain_nodes", view.domain_count},
      {"levels", view.levels},
      {"complete_levels", info.levels},
      {"bytes", model.bytes.size()},
      {"dense_bytes", block_bytes * view.domain_count * view.domain_count},
      {"kept_blocks", finest.kept_blocks},
      {"dense_blocks", finest.dense_blocks},
      {"rms_error", finest.rms_error},
      {"worst_column_error", finest.worst_column_error},
      {"worst_patch_force_error", finest.patch_force_error},
      {"field_blocks", field["blocks"]},
      {"longest_field_column", field["longest"]},
      {"field_rms_error", finest.field_rms_error},
      {"field_column_error", finest.field_column_error},
      {"lambda_min", info.lambda_min},
      {"certificate", info.lambda_min > 0},
      {"wavelet", wavelet_name(info.wavelet)},
      {"wavelets", recorded(view, "wavelets", Json::array())},
      {"bits", bits_of(view)},
      {"threshold", info.threshold},
      {"frontier", recorded(view, "frontier", Json::array())},
      {"frontier_contacts", recorded(view, "frontier_contacts", nullptr)},
      {"store_asymmetry", info.store_asymmetry},
      {"material", material_of(view)},
      {"box", {{"min", info.box_min}, {"max", info.box_max}}},
      {"scene", {{"rate", info.rate}, {"max_contacts", info.max_contacts}, {"step_work", info.step_work}}},
      {"budget", budget},
      {"units", units_of(view)},
      {"constraint_levels", levels_of(view)},
      {"patterns", patterns_of(view)},
      {"mesh_error", recorded(view, "mesh_error", nullptr)},
      {"loads", loads_of(view)},
      {"vertices", view.vertices.size()},
      {"ready", view.ready.read != nullptr},
      {"ready_bytes", ready_bytes(view)},
      {"provenance", provenance_of(view)},
      {"sections", sections_of(model)},
  };
}

std::string percent(const Json& value) { return fmt::format("{:.3g} %", 100 * value.get<double>()); }

std::string ratio(const Json& of, const Json& to) { return fmt::format("{:.1f}", of.get<double>() / to.get<double>()); }

std::string bytes_text(const Json& value) {
  const auto bytes = value.get<double>();
  if (bytes < 1e3) return fmt::format("{:.0f} B", bytes);
  return bytes < 1e6 ? fmt::format("{:.1f} kB", bytes / 1e3) : fmt::format("{:.1f} MB", bytes / 1e6);
}

std::string field_text(const Json& found) {
  std::string errors = fmt::format("compression error {} RMS, {} in the worst column",
                                   percent(found["field_rms_error"]), percent(found["field_column_error"]));
  if (found["field_blocks"].is_null()) return errors;
  return fmt::format("{}; summed of {} blocks, at most {} by a force on one node", errors, found["field_blocks"].dump(),
                     found["longest_field_column"].dump());
}

std::string certificate_text(const Json& found) {
  if (!found["certificate"].get<bool>()) return "none";
  const Json& unit = found["units"]["compliance"];
  return fmt::format("every eigenvalue of the compliance is above {:.3g}{} (verify --certificate)",
                     found["lambda_min"].get<double>(), unit.is_null() ? "" : " " + unit.get<std::string>());
}

// "acceleration along x (0.12, 0, 0 N per m/s^2); ..."
std::string loads_text(const Json& loads) {
  std::string text;
  for (const Json& load : loads) {
    const auto force = load["resultant"].get<std::array<float, 3>>();
    text += fmt::format("{}{} ({:.4g} N per {})", text.empty() ? "" : "; ", load["name"].get<std::string>(),
                        fmt::join(force, ", "), load["unit"].get<std::string>());
  }
  return text.empty() ? "none" : text;
}

// what the mesh itself costs, as the build estimated it
std::string mesh_error_text(const Json& error) {
  if (!error.is_object() || !error.contains("force") || !error["force"].is_number()) return "not estimated";
  return fmt::format("forces of pressed patches up to {} too large, extrapolated from quadratic elements",
                     percent(error["force"]));
}

void print_table(const std::filesystem::path& file, const Json& found, std::ostream& out) {
  const auto row = [&](std::string_view name, const std::string& value) {
    fmt::print(out, "  {:<20}{}\n", name, value);
  };
  const auto& material = found["material"];
  const auto& scene = found["scene"];
  fmt::print(out, "{}  (format {})\n", file.string(), found["version"].get<std::string>());
  print_quality(found["quality"], out);
  fmt::print(out, "\n");
  row("problem", found["problem"].get<std::string>());
  row("nodes", fmt::format("{}, {} of them in the domain", found["nodes"].dump(), found["domain_nodes"].dump()));
  row("levels", fmt::format("{} of {}", found["levels"].dump(), found["complete_levels"].dump()));
  row("bytes", fmt::format("{}: {} times fewer than the dense matrix ({})", bytes_text(found["bytes"]),
                           ratio(found["dense_bytes"], found["bytes"]), bytes_text(found["dense_bytes"])));
  row("kept blocks", fmt::format("{} of {}: {} times fewer", found["kept_blocks"].dump(), found["dense_blocks"].dump(),
                                 ratio(found["dense_blocks"], found["kept_blocks"])));
  row("wavelet", found["wavelet"].get<std::string>());
  row("field", field_text(found));
  row("mesh error", mesh_error_text(found["mesh_error"]));
  row("certificate", certificate_text(found));
  if (!material.is_null()) {
    row("material",
        fmt::format("Young's modulus {} Pa, Poisson's ratio {}", material["young"].dump(), material["poisson"].dump()));
  }
  row("loads", loads_text(found["loads"]));
  row("vertex map", found["vertices"] == 0 ? "none" : fmt::format("{} vertices", found["vertices"].dump()));
  row("ready", found["ready"].get<bool>() ? "yes, " + bytes_text(found["ready_bytes"]) + " of the file" : "no");
  row("scene", fmt::format("{} Hz, at most {} contacts, {} units of work per step", scene["rate"].dump(),
                           scene["max_contacts"].dump(), scene["step_work"].dump()));
  for (const auto& [name, value] : budget_rows(found["budget"])) row(name, value);
  fmt::print(out, "\n  compression error, level by level\n  {:<6}{:>9}{:>13}{:>13}{:>13}{:>14}{:>13}\n", "level",
             "columns", "kept blocks", "dense", "RMS", "worst column", "patch force");
  for (const auto& level : found["constraint_levels"]) {
    fmt::print(out, "  {:<6}{:>9}{:>13}{:>13}{:>13}{:>14}{:>13}\n", level["level"].dump(), level["columns"].dump(),
               level["kept_blocks"].dump(), level["dense_blocks"].dump(), percent(level["rms_error"]),
               percent(level["worst_column_error"]), percent(level["worst_patch_force_error"]));
  }
  print_patterns(found["patterns"], out);
}

}  // namespace

int run_inspect(const InspectArguments& arguments, std::ostream& out) {
  const ModelFile model = open_model_file(arguments.file);
  const bool motion = model.view.problem == layout::Problem::impulse_response;
  const bool elastic = model.view.problem == layout::Problem::multigrid;
  Json found = motion    ? motion_inspection(model, provenance_of(model.view))
               : elastic ? elastic_inspection(model, provenance_of(model.view))
                         : inspection_of(model);
  if (motion || elastic) found["sections"] = sections_of(model);
  if (arguments.json) {
    out << json_text(found) << '\n';
  } else {
    const auto print = motion ? print_motion_table : elastic ? print_elastic_table : print_table;
    print(arguments.file, found, out);
    if (arguments.provenance) fmt::print(out, "\n  provenance: {}\n", json_text(found["provenance"]));
  }
  return 0;
}

void add_inspect(CLI::App& parent, int& exit_code) {
  CLI::App* command =
      parent.add_subcommand("inspect",
                            "Say what a model file holds, and what its budget is on this machine: steps "
                            "are run for a quarter of a second of processor time");
  const auto arguments = std::make_shared<InspectArguments>();
  command->add_option("model", arguments->file, "Model file (.gloop)")->required();
  command->add_flag("--provenance", arguments->provenance, "Print what the model was made from, too");
  command->add_flag("--json", arguments->json, "Print JSON, with provenance and every section");
  command->callback([arguments, &exit_code] {
    std::ostringstream out;
    exit_code = run_inspect(*arguments, out);
    print_result(out.str());
  });
}

}  // namespace greenloop::offline
