#include "offline/cli/inspect_budget.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "offline/cli/step_speed.hpp"

namespace greenloop::offline {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t most_arena = std::size_t{1} << 30;  // bytes of a body that is made to be measured
constexpr double seconds = 0.25;

// the shortest decimal that reads back as the same float
double as_written(float value) { return std::stod(fmt::format("{}", value)); }

// what the file and the declarations say, and the rest null
Json declared(const Elastostatic::Intent& intent, const Elastostatic::Requirement& need, std::uint64_t work) {
  const double share = as_written(intent.share), rate = as_written(intent.rate);
  return {{"work", work},
          {"us", nullptr},
          {"us_p95", nullptr},
          {"rate", rate},
          {"share", share},
          {"share_us", 1e6 * share / rate},
          {"contacts", intent.limits.max_contacts},
          {"least_work", need.least_work},
          {"least_us", nullptr},
          {"worst_work", *std::max_element(std::begin(need.worst_work), std::end(need.worst_work))},
          {"worst_us", nullptr},
          {"units_per_us", nullptr},
          {"steps", 0},
          {"arena_bytes", need.bytes},
          {"create_ms", nullptr}};
}

void add_times(const StepSpeed& speed, Json& budget) {
  const auto us = [&](const char* work, double us_per_unit) { return us_per_unit * budget[work].get<double>(); };
  budget["create_ms"] = speed.create_ms;
  budget["steps"] = speed.steps;
  if (speed.steps == 0) return;
  budget["us"] = us("work", speed.us_per_unit);
  budget["us_p95"] = us("work", speed.us_per_unit_p95);
  budget["least_us"] = us("least_work", speed.us_per_unit);
  budget["worst_us"] = us("worst_work", speed.us_per_unit);
  budget["units_per_us"] = 1 / speed.us_per_unit;
}

// of a model that there are no bodies of
Json undeclared(const layout::Info& info) {
  Elastostatic::Intent intent;
  intent.limits.max_contacts = info.max_contacts;
  intent.rate = info.rate;
  intent.share = info.share > 0 ? info.share : 1;
  Json budget = declared(intent, {}, info.step_work);
  for (const char* key : {"least_work", "worst_work", "arena_bytes"}) budget[key] = nullptr;
  return budget;
}

std::string us_text(const Json& us) { return us.is_null() ? "" : fmt::format(", {:.4g} us", us.get<double>()); }

}  // namespace

Json budget_of(const ModelFile& model) {
  const Model opened = Model::open(model.bytes.span()).model;
  const auto intent = Elastostatic::intended(opened);
  const auto need = Elastostatic::required(opened, intent.limits);
  if (need.bytes == 0) return undeclared(*model.view.info);
  Json budget = declared(intent, need, intent.budget.work);
  if (need.bytes > most_arena) return budget;
  const Budget any{std::max(intent.budget.work, need.least_work)};
  if (const auto speed = measure_speed(opened, intent.limits, any, seconds)) add_times(*speed, budget);
  return budget;
}

std::vector<std::pair<std::string, std::string>> budget_rows(const Json& budget) {
  const std::string step = fmt::format("{} units a step{}", budget["work"].dump(), us_text(budget["us"]));
  const std::string percentile = budget["us_p95"].is_null() ? ""
                                                            : fmt::format(" (by the 95th percentile of steps {:.4g})",
                                                                          budget["us_p95"].get<double>());
  std::vector<std::pair<std::string, std::string>> rows = {
      {"budget", fmt::format("{}{}; {:.4g} % of a period at {} Hz is {:.4g} us", step, percentile,
                             100 * budget["share"].get<double>(), budget["rate"].get<double>(),
                             budget["share_us"].get<double>())}};
  if (budget["least_work"].is_null()) return rows;
  rows.emplace_back("declared",
                    fmt::format("at least {} units{}; at most {} units{}", budget["least_work"].dump(),
                                us_text(budget["least_us"]), budget["worst_work"].dump(), us_text(budget["worst_us"])));
  rows.emplace_back("body", budget["create_ms"].is_null()
                                ? fmt::format("{} bytes; not made to be measured", budget["arena_bytes"].dump())
                                : fmt::format("{} bytes, made in {:.3g} ms", budget["arena_bytes"].dump(),
                                              budget["create_ms"].get<double>()));
  if (!budget["units_per_us"].is_null()) {
    rows.emplace_back("this machine", fmt::format("{:.4g} units per us, by {} steps that were run for a moment",
                                                  budget["units_per_us"].get<double>(), budget["steps"].dump()));
  }
  return rows;
}

}  // namespace greenloop::offline
