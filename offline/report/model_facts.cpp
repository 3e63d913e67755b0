#include "offline/report/model_facts.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <span>

#include "offline/report/axis.hpp"

namespace greenloop::offline {
namespace {

using layout::SectionKind;

constexpr std::array<std::pair<SectionKind, const char*>, 9> kind_names{
    {{SectionKind::info, "info"},
     {SectionKind::provenance, "provenance"},
     {SectionKind::level, "levels"},
     {SectionKind::nodes, "nodes"},
     {SectionKind::base_triangles, "base triangles"},
     {SectionKind::refinement, "refinement"},
     {SectionKind::columns, "columns"},
     {SectionKind::representatives, "representatives"},
     {SectionKind::blocks, "wavelet blocks"}}};

std::span<const layout::SectionEntry> section_entries(const ModelView& model) {
  return {reinterpret_cast<const layout::SectionEntry*>(model.header + 1), model.header->section_count};
}

std::string kind_name(std::uint32_t kind) {
  for (const auto& [known, name] : kind_names) {
    if (static_cast<std::uint32_t>(known) == kind) return name;
  }
  return fmt::format("unknown kind {}", kind);
}

std::uint64_t block_bytes(const ModelView& model, std::uint32_t c) {
  std::uint64_t bytes = 0;
  for (const layout::SectionEntry& entry : section_entries(model)) {
    if (entry.kind == static_cast<std::uint32_t>(SectionKind::blocks) && entry.a == c) bytes += entry.bytes;
  }
  return bytes;
}

const layout::Level& finest_constraint(const ModelView& model) {
  std::uint32_t q = model.levels - 1;
  while (q > 0 && model.level[q].counts->column_count == 0) --q;
  return *model.level[q].counts;
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
  return {"Body",
          {{"nodes", readable_count(model.node_count)},
           {"moving nodes stored", readable_count(model.domain_count)},
           {"touchable", readable_count(surface.count(layout::node_touchable))},
           {"fixed", readable_count(surface.count(layout::node_fixed))},
           {"read by the scene", readable_count(surface.count(layout::node_read))},
           {"mesh levels", levels},
           {"base mesh", fmt::format("{} nodes, {} triangles", model.level[0].counts->node_count,
                                     model.level[0].counts->base_triangle_count)},
           {"size", fmt::format("{} × {} × {}\u202fmm", millimetres(0), millimetres(1), millimetres(2))},
           {"Young's modulus", with_prefix(model.info->young, "Pa")},
           {"Poisson's ratio", readable(model.info->poisson)}}};
}

FactGroup compression_facts(const ModelView& model) {
  const layout::Level& finest = finest_constraint(model);
  const auto dense = static_cast<double>(dense_bytes(model)), file = static_cast<double>(model.header->file_bytes);
  const double kept = static_cast<double>(std::max<std::uint64_t>(finest.kept_blocks, 1));
  return {"Compression",
          {{"model file", readable_bytes(file)},
           {"dense columns, float32", readable_bytes(dense)},
           {"smaller by", times(dense / file)},
           {"blocks kept",
            fmt::format("{} of {}", readable_count(finest.kept_blocks), readable_count(finest.dense_blocks))},
           {"fewer blocks by", times(static_cast<double>(finest.dense_blocks) / kept)},
           {"RMS error", readable_percent(finest.rms_error)},
           {"worst column's error", readable_percent(finest.worst_column_error)},
           {"threshold ε", readable(model.info->epsilon)},
           {"asymmetry of the exact columns", readable(model.info->store_asymmetry, 2)}}};
}

FactGroup loop_facts(const ModelView& model) {
  return {"Asked of the loop",
          {{"rate", readable(model.info->rate) + "\u202fHz"},
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
    const std::string name = kind_name(entry.kind);
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

std::uint64_t dense_bytes(const ModelView& model) { return finest_constraint(model).dense_blocks * 9 * sizeof(float); }

std::vector<FactGroup> model_facts(const ModelView& model, const ModelSurface& surface) {
  return {body_facts(model, surface), compression_facts(model), loop_facts(model)};
}

Table level_table(const ModelView& model, const std::optional<TraceSummary>& trace) {
  Table table{{"constraint level", "columns", "blocks per column", "of all blocks", "work per column", "block bytes",
               "RMS error", "worst column", "patch force"},
              {}};
  std::size_t answered = 0;
  if (trace) {
    table.head.emplace_back("cycles");
    for (const std::size_t count : trace->cycles_at_level) answered += count;
  }
  for (std::uint32_t c = 0; c < model.levels; ++c) {
    const layout::Level& level = *model.level[c].counts;
    if (level.column_count == 0) continue;
    const double per_column = static_cast<double>(level.kept_blocks) / level.column_count;
    table.rows.push_back(
        {fmt::format("{}", c), readable_count(level.column_count), readable(per_column, 4),
         readable_percent(static_cast<double>(level.kept_blocks) / static_cast<double>(level.dense_blocks)),
         readable(9 * per_column, 4), readable_bytes(static_cast<double>(block_bytes(model, c))),
         readable_percent(level.rms_error), readable_percent(level.worst_column_error),
         readable_percent(level.force_error)});
    if (!trace) continue;
    const std::size_t used = c < trace->cycles_at_level.size() ? trace->cycles_at_level[c] : 0;
    table.rows.back().push_back(
        answered > 0 ? readable_percent(static_cast<double>(used) / static_cast<double>(answered)) : "–");
  }
  return table;
}

}  // namespace greenloop::offline
