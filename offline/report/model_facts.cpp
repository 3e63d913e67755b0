#include "offline/report/model_facts.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string_view>

#include "formats/stored_blocks.hpp"
#include "formats/write/describe.hpp"
#include "formats/write/nested_json.hpp"
#include "offline/compress/measure/field_size.hpp"
#include "offline/report/axis.hpp"

namespace greenloop::offline {
namespace {

using layout::SectionKind;

/// "base triangles" for BaseTriangles.
std::string in_words(std::string_view name) {
  std::string words;
  for (const char letter : name) {
    const bool capital = letter >= 'A' && letter <= 'Z';
    if (capital && !words.empty()) words += ' ';
    words += capital ? static_cast<char>(letter - 'A' + 'a') : letter;
  }
  return words;
}

std::string kind_name(const layout::SectionEntry& entry) {
  const auto kind = static_cast<SectionKind>(entry.kind);
  if (kind == SectionKind::couplings) return fmt::format("couplings, {} bits", layout::value_bits[entry.b]);
  for (const layout::SectionForm& form : layout::section_forms) {
    if (form.kind == kind) return in_words(form.name);
  }
  return fmt::format("unknown kind {}", entry.kind);
}

const layout::Level& finest_level(const ModelView& model) { return *model.level[model.levels - 1].counts; }

/// Bytes of scales and couplings of mesh level q.
std::uint64_t compliance_bytes(const ModelView& model, std::uint32_t q) {
  const std::uint64_t components = model.info->components;
  std::uint64_t bytes = model.level[q].counts->domain_count * components * (components + 1) * sizeof(float);
  for (const layout::SectionEntry& entry : section_entries(model)) {
    if (entry.kind == static_cast<std::uint32_t>(SectionKind::couplings) && entry.a == q) bytes += entry.bytes;
  }
  return bytes;
}

/// The couplings by the bits of their values, e.g. "32: 9, 16: 12 905, 8: 112 433".
std::string coupling_bits(const ModelView& model) {
  std::map<std::uint32_t, std::uint64_t, std::greater<>> blocks;
  for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
    const std::uint64_t count = block_count(model, layer, layer + 1);
    if (count > 0) blocks[layout::value_bits[layer]] += count;
  }
  std::string text;
  for (const auto& [width, count] : blocks) {
    text += fmt::format("{}{}: {}", text.empty() ? "" : ", ", width, readable_count(count));
  }
  return text.empty() ? "none" : text;
}

std::string certificate(const ModelView& model) {
  if (!(model.info->lambda_min > 0)) return "none";
  return fmt::format("every eigenvalue is above {}{}{}", readable(model.info->lambda_min, 3),
                     model.problem == layout::Problem::elastostatic ? "\u202fm/N" : "",
                     model.levels < model.info->levels ? " (of the model before it was cut off)" : "");
}

std::string with_prefix(double value, const std::string& unit) {
  const SiPrefix prefix = si_prefix(value);
  return readable(value / prefix.factor, 4) + "\u202f" + prefix.symbol + unit;
}

std::string times(double ratio) { return readable(ratio, 3) + "×"; }

FactGroup body_facts(const ModelView& model, const ModelSurface& surface) {
  const auto& low = model.info->box_min;
  const auto& high = model.info->box_max;
  const auto millimetres = [&](int axis) { return readable(1000 * (static_cast<double>(high[axis]) - low[axis]), 3); };
  std::string levels = fmt::format("{}", model.levels);
  if (model.levels < model.info->levels) levels += fmt::format(" of {}: the file is cut off", model.info->levels);
  FactGroup group{"Body",
                  {{"problem", std::string(problem_name(model.problem))},
                   {"nodes", readable_count(model.node_count)},
                   {"moving nodes stored", readable_count(model.domain_count)},
                   {"touchable", readable_count(surface.count(layout::node_touchable))},
                   {"fixed", readable_count(surface.count(layout::node_fixed))},
                   {"read by the scene", readable_count(surface.count(layout::node_read))},
                   {"mesh levels", levels},
                   {"base mesh", fmt::format("{} nodes, {} triangles", model.level[0].counts->node_count,
                                             model.level[0].counts->base_triangle_count)},
                   {"size", fmt::format("{} × {} × {}\u202fmm", millimetres(0), millimetres(1), millimetres(2))}}};
  if (model.problem == layout::Problem::elastostatic) {
    group.facts.push_back({"Young's modulus", with_prefix(model.info->young, "Pa")});
    group.facts.push_back({"Poisson's ratio", readable(model.info->poisson)});
  }
  return group;
}

FactGroup compression_facts(const ModelView& model) {
  const layout::Level& finest = finest_level(model);
  const auto dense = static_cast<double>(dense_bytes(model)), file = static_cast<double>(model.header->file_bytes);
  const double kept = static_cast<double>(std::max<std::uint64_t>(finest.kept_blocks, 1));
  FactGroup group{"Compression",
                  {{"model file", readable_bytes(file)},
                   {"dense compliance, float32", readable_bytes(dense)},
                   {"smaller by", times(dense / file)},
                   {"blocks kept",
                    fmt::format("{} of {}", readable_count(finest.kept_blocks), readable_count(finest.dense_blocks))},
                   {"fewer blocks by", times(static_cast<double>(finest.dense_blocks) / kept)},
                   {"wavelet", std::string(wavelet_name(model.info->wavelet))},
                   {"couplings by bits per value", coupling_bits(model)},
                   {"compression error, RMS", readable_percent(finest.rms_error)},
                   {"compression error, worst column", readable_percent(finest.worst_column_error)},
                   {"compression error, worst patch force", readable_percent(finest.patch_force_error)},
                   {"compression error of the field, RMS", readable_percent(finest.field_rms_error)},
                   {"compression error of the field, worst column", readable_percent(finest.field_column_error)},
                   {"positive definite", certificate(model)},
                   {"threshold", readable(model.info->threshold)},
                   {"asymmetry of the exact columns", readable(model.info->store_asymmetry, 2)}}};
  if (model.problem == layout::Problem::elastostatic) {
    const FieldSize field = field_size(model);
    group.facts.push_back(
        {"blocks that a field is summed of", fmt::format("{}, at most {} by a force on one node",
                                                         readable_count(field.blocks), readable_count(field.longest))});
  }
  return group;
}

FactGroup loop_facts(const ModelView& model) {
  return {"Asked of the loop",
          {{"rate", readable(model.info->rate) + "\u202fHz"},
           {"share of a period", model.info->share > 0 ? readable(100 * model.info->share) + "\u202f%" : "none stated"},
           {"contacts at most", readable_count(model.info->max_contacts)},
           {"work per step", readable_count(model.info->step_work) + " units"},
           {"constraint levels", fmt::format("{} to {}", model.info->coarsest_constraint_level,
                                             std::min(model.info->finest_constraint_level, model.levels - 1))},
           {"file format", fmt::format("{}.{}", model.header->major, model.header->minor)}}};
}

}  // namespace

std::vector<KindBytes> bytes_by_kind(const ModelView& model) {
  std::vector<KindBytes> kinds;
  std::uint64_t rest = model.header->file_bytes;
  for (const layout::SectionEntry& entry : section_entries(model)) {
    const std::string name = kind_name(entry);
    auto at = std::find_if(kinds.begin(), kinds.end(), [&](const KindBytes& kind) { return kind.name == name; });
    if (at == kinds.end()) at = kinds.insert(kinds.end(), {name, 0});
    at->bytes += entry.bytes;
    rest -= entry.bytes;
  }
  std::stable_sort(kinds.begin(), kinds.end(),
                   [](const KindBytes& a, const KindBytes& b) { return a.bytes > b.bytes; });
  kinds.push_back({"header, table, padding", rest});
  return kinds;
}

std::uint64_t dense_bytes(const ModelView& model) {
  return finest_level(model).dense_blocks * model.info->components * model.info->components * sizeof(float);
}

std::vector<FactGroup> model_facts(const ModelView& model, const ModelSurface& surface) {
  return {body_facts(model, surface), compression_facts(model), loop_facts(model)};
}

Table level_table(const ModelView& model, const std::optional<TraceSummary>& trace) {
  Table table{{"constraint level", "nodes", "blocks", "of dense", "bytes", "RMS error", "worst column", "patch force"},
              {}};
  std::size_t answered = 0;
  if (trace) {
    table.head.emplace_back("cycles");
    for (const std::size_t count : trace->cycles_at_level) answered += count;
  }
  std::uint64_t bytes = 0;
  for (std::uint32_t c = 0; c < model.levels; ++c) {
    const layout::Level& level = *model.level[c].counts;
    bytes += compliance_bytes(model, c);
    if (c < model.info->coarsest_constraint_level) continue;
    table.rows.push_back(
        {fmt::format("{}", c), readable_count(model.level[c].domain_begin + level.domain_count),
         readable_count(level.kept_blocks),
         readable_percent(static_cast<double>(level.kept_blocks) / static_cast<double>(level.dense_blocks)),
         readable_bytes(static_cast<double>(bytes)), readable_percent(level.rms_error),
         readable_percent(level.worst_column_error), readable_percent(level.patch_force_error)});
    if (!trace) continue;
    const std::size_t used = c < trace->cycles_at_level.size() ? trace->cycles_at_level[c] : 0;
    table.rows.back().push_back(
        answered > 0 ? readable_percent(static_cast<double>(used) / static_cast<double>(answered)) : "–");
  }
  return table;
}

Table mesh_error_table(const ModelView& model) {
  Table table{{"place [mm]", "direction", "mesh error"}, {}};
  if (!is_shallow({model.provenance.data(), model.provenance.size()})) return table;
  const auto root = nlohmann::json::parse(model.provenance.begin(), model.provenance.end(), nullptr, false);
  const nlohmann::json::json_pointer patches("/mesh_error/patches");
  if (!root.is_object() || !root.contains(patches) || !root[patches].is_array()) return table;
  for (const auto& patch : root[patches]) {
    if (!patch.is_object() || !patch.contains("error") || !patch["error"].is_number()) continue;
    std::string place;
    for (const auto& x : patch.value("center", nlohmann::json::array())) {
      place += (place.empty() ? "" : ", ") + (x.is_number() ? readable(1000 * x.get<double>(), 3) : "?");
    }
    const bool named = patch.contains("axis") && patch["axis"].is_string();
    table.rows.push_back(
        {place, named ? patch["axis"].get<std::string>() : "?", readable_percent(patch["error"].get<double>())});
  }
  return table;
}

std::vector<LevelErrors> level_errors(const ModelView& model) {
  std::vector<LevelErrors> errors;
  for (std::uint32_t c = model.info->coarsest_constraint_level; c < model.levels; ++c) {
    const layout::Level& level = *model.level[c].counts;
    errors.push_back({c, level.rms_error, level.worst_column_error, level.patch_force_error});
  }
  return errors;
}

}  // namespace greenloop::offline
