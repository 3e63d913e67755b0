#include "offline/cli/inspect_patterns.hpp"

#include <fmt/format.h>
#include <fmt/ostream.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "formats/write/describe.hpp"

namespace greenloop::offline {
namespace {

using Json = nlohmann::ordered_json;

Json quantiles_of(const float (&error)[3]) { return {{"median", error[0]}, {"p95", error[1]}, {"worst", error[2]}}; }

Json pattern_of(const layout::PatternRecord& record, std::uint32_t level) {
  const bool total = layout::has_total_force(static_cast<layout::PatternKind>(record.kind));
  return {{"kind", pattern_name(record.kind)},
          {"contacts", record.contacts},
          {"level", level},
          {"samples", record.samples},
          {"field_error", quantiles_of(record.field_error)},
          {"field_peak", quantiles_of(record.field_peak)},
          {"force_error", quantiles_of(record.force_error)},
          {"total_force_error", total ? quantiles_of(record.total_force_error) : Json(nullptr)}};
}

// the worst errors of a kind over all numbers of contacts
struct KindRow {
  std::string kind;
  std::string contacts;
  double field = 0, peak = 0, force = 0, total = -1;
};

double worst_of(const Json& error) { return error.is_null() ? -1 : error["worst"].get<double>(); }

std::vector<KindRow> rows_of(const Json& patterns, const Json& level) {
  std::vector<KindRow> rows;
  for (const auto& pattern : patterns) {
    if (pattern["level"] != level) continue;
    const auto kind = pattern["kind"].get<std::string>();
    if (rows.empty() || rows.back().kind != kind) rows.push_back({.kind = kind, .contacts = {}});
    KindRow& row = rows.back();
    row.contacts += (row.contacts.empty() ? "" : ", ") + pattern["contacts"].dump();
    row.field = std::max(row.field, worst_of(pattern["field_error"]));
    row.peak = std::max(row.peak, worst_of(pattern["field_peak"]));
    row.force = std::max(row.force, worst_of(pattern["force_error"]));
    row.total = std::max(row.total, worst_of(pattern["total_force_error"]));
  }
  return rows;
}

std::string percent(double value) { return value < 0 ? "-" : fmt::format("{:.3g} %", 100 * value); }

}  // namespace

Json patterns_of(const ModelView& view) {
  Json patterns = Json::array();
  for (std::uint32_t level = 0; level < view.levels; ++level) {
    for (const auto& record : view.level[level].patterns) patterns.push_back(pattern_of(record, level));
  }
  return patterns;
}

void print_patterns(const Json& patterns, std::ostream& out) {
  if (patterns.empty()) return;
  const Json& level = patterns.back()["level"];
  fmt::print(out, "\n  what people do, resolved at level {}: the worst compression error of each kind\n", level.dump());
  fmt::print(out, "  {:<13}{:<18}{:>10}{:>13}{:>13}{:>13}\n", "kind", "contacts", "field", "worst node", "node forces",
             "total force");
  for (const KindRow& row : rows_of(patterns, level)) {
    fmt::print(out, "  {:<13}{:<18}{:>10}{:>13}{:>13}{:>13}\n", row.kind, row.contacts, percent(row.field),
               percent(row.peak), percent(row.force), percent(row.total));
  }
}

}  // namespace greenloop::offline
