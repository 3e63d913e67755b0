#include "offline/report/verdict.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "offline/pipeline/model_quality.hpp"
#include "offline/report/axis.hpp"
#include "offline/scene/scene.hpp"
#include "runtime/elastostatic.hpp"

namespace greenloop::offline {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* nothing = "–";

constexpr std::pair<const char*, const char*> compression_errors[] = {
    {"rms", "compression error, RMS of single forces"},
    {"worst_column", "compression error, worst single force"},
    {"patch_force", "compression error, forces of a patch"},
    {"field", "compression error, field of what people do"},
    {"field_peak", "compression error, its worst node"},
    {"field_rough", "compression error, field of rough patches"}};

std::string percent_or(const Json& value, const char* otherwise) {
  return value.is_number() ? readable_percent(value.get<double>()) : otherwise;
}

void add_error(const std::string& what, const Json& error, std::vector<Judgement>& rows) {
  const Json& asked = error["asked"];
  const Json& reached = error["reached"];
  if (!asked.is_number() && !reached.is_number()) return;
  Judgement row{what, percent_or(asked, nothing), percent_or(reached, "not measured")};
  if (error["held"].is_boolean()) row.held = error["held"].get<bool>();
  rows.push_back(row);
}

void add_run(const TraceSummary& run, std::vector<Judgement>& rows) {
  const bool held = run.misses == 0;
  rows.push_back({"missed cycles of the run", "0",
                  fmt::format("{} of {}", readable_count(run.misses), readable_count(run.cycles)), held});
  rows.push_back({"its dearest cycle, of the budget", "100\u202f%", readable_percent(run.worst_share)});
}

/// What a body of the loop takes.
void add_body(const ModelFile& model, double units_per_us, std::vector<Judgement>& rows) {
  const Model opened = Model::open(model.bytes.span()).model;
  const auto intent = Elastostatic::intended(opened);
  const auto need = Elastostatic::required(opened, intent.limits);
  if (need.bytes == 0) return;
  const double work = static_cast<double>(intent.budget.work), us = work / units_per_us;
  const double share_us = 1e6 * intent.share / intent.rate;
  rows.push_back({"work of a step, units: least, budget", nothing,
                  fmt::format("{}, {}", readable_count(need.least_work), readable_count(intent.budget.work))});
  Judgement time{fmt::format("the budget in time, at {} units per µs", readable(units_per_us)),
                 readable(share_us) + "\u202fµs", readable(us) + "\u202fµs"};
  if (model.view.info->share > 0) time.held = us <= share_us * (1 + 1e-6);
  rows.push_back(time);
  rows.push_back({fmt::format("RAM of a body for {} contacts", intent.limits.max_contacts), nothing,
                  readable_bytes(static_cast<double>(need.bytes))});
}

void add_certificate(const layout::Info& info, std::vector<Judgement>& rows) {
  Judgement row{"positive definite", "yes", "not certified"};
  if (info.lambda_min > 0) row.reached = "yes, certified", row.held = true;
  rows.push_back(row);
}

// `errors`: what is said of the compression and the mesh
void conclude(const Json& quality, const std::optional<TraceSummary>& run, Verdict& verdict) {
  const std::string errors = quality["sentence"];
  const bool judged = quality["verdict"] != "NOT JUDGED";
  const bool missed = run && run->misses > 0;
  if (judged) verdict.good = quality["verdict"] == "HELD";
  if (missed) verdict.good = false;
  const std::string misses = missed ? fmt::format("{} of {} cycles of the run were missed; ",
                                                  readable_count(run->misses), readable_count(run->cycles))
                                    : "";
  const char* const good = quality["warning"].is_null() ? "Good enough" : "As asked";
  const char* const opening = !verdict.good ? "Not judged" : *verdict.good ? good : "Not good enough";
  verdict.sentence = fmt::format("{}: {}{}.", opening, misses, errors);
}

}  // namespace

Verdict verdict_of(const ModelFile& model, const std::optional<BuildRecord>& build,
                   const std::optional<TraceSummary>& run) {
  const Json quality = quality_of(model.view, {});
  Verdict verdict;
  for (const auto& [key, what] : compression_errors) add_error(what, quality["compression_error"][key], verdict.rows);
  add_error("mesh error, forces of pressed patches", quality["mesh_error"], verdict.rows);
  if (run) add_run(*run, verdict.rows);
  const double speed = build && build->units_per_us ? *build->units_per_us : nominal_units_per_us;
  if (model.view.problem == layout::Problem::elastostatic) add_body(model, speed, verdict.rows);
  add_certificate(*model.view.info, verdict.rows);
  conclude(quality, run, verdict);
  return verdict;
}

}  // namespace greenloop::offline
