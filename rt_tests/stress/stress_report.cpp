#include "rt_tests/stress/stress_report.hpp"

#include <fmt/format.h>

#include "rt_tests/stress/report_parts.hpp"

namespace greenloop {
namespace {

using nlohmann::json;

json as_json(const ScriptResult& script) {
  return {{"name", name(script.kind)},
          {"cycles", script.cycles},
          {"answered", script.counts.answers()},
          {"coarser", script.counts.of(Status::coarser)},
          {"cached", script.counts.cached},
          {"changed", script.counts.changed},
          {"mixed_levels", 0},  // sets are of one level
          {"waiting", script.counts.waiting},
          {"refused", script.counts.refusals()},
          {"worst_work", script.counts.worst_work},
          {"worst_us", script.worst_us},
          {"force_step_max", script.force_step_max},
          {"digest", fmt::format("{:016x}", script.digest)}};
}

json as_json(const StarvedSteps& starved) {
  return {{"finest_N", starved.finest},
          {"tenth_over_finest", starved.tenth},
          {"quarter_over_finest", starved.quarter},
          {"apart_over_finest", starved.apart}};
}

void print_scripts(const std::vector<ScriptResult>& scripts) {
  fmt::print("{:<12} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>12} {:>9} {:>10}\n", "script", "cycles", "answered",
             "coarser", "waiting", "cached", "changed", "refused", "worst work", "worst us", "force step");
  for (const ScriptResult& s : scripts) {
    fmt::print("{:<12} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>12} {:>9.0f} {:>10.2g}\n", name(s.kind), s.cycles,
               s.counts.answers(), s.counts.of(Status::coarser), s.counts.waiting, s.counts.cached, s.counts.changed,
               s.counts.refusals(), s.counts.worst_work, s.worst_us, s.force_step_max);
  }
}

void print_counts(const StressResult& result) {
  print_statuses(result.counts.by_status);
  fmt::print("answers by constraint level:");
  for (std::uint32_t c = 0; c < layout::max_levels; ++c) {
    if (result.counts.by_level[c] > 0) {
      fmt::print("  {}: {}", c, result.counts.by_level[c]);
    }
  }
  fmt::print("\n");
}

void print_predicted(const PredictedWork& predicted) {
  fmt::print("units of work over instructions:\n");
  print_ratios(predicted.ways, predicted.all);
}

}  // namespace

std::string StressReport::verdict() const { return verdict_of(result.violations); }

std::string StressReport::replay() const {
  if (!result.first_violation) {
    return {};
  }
  return fmt::format("greenloop-stress {} --seed {} --script {} --cycles {} --contacts {} --factors {}", model,
                     options.seed, name(result.first_violation->script), result.first_violation->cycle + 1,
                     options.contacts, options.factors);
}

nlohmann::json StressReport::json() const {
  nlohmann::json all = {{"model", model},
                        {"seed", options.seed},
                        {"contacts", options.contacts},
                        {"factors", options.factors},
                        {"cycles", result.cycles},
                        {"worst_work", result.counts.worst_work},
                        {"declared_work", result.declared_work},
                        {"declared_over_worst", declared_over_worst()},
                        {"predicted_over_instructions", nullptr},
                        {"force_step_over_finest", starved.tenth},
                        {"force_steps", as_json(starved)},
                        {"time", time},
                        {"time_verdict", time.word()},
                        {"instructions_max", nullptr},
                        {"force_step_max", result.force_step_max},
                        {"digest", fmt::format("{:016x}", result.digest)},
                        {"open_ms", open_ms},
                        {"create_ms", result.create_ms},
                        {"arena_bytes", result.arena_bytes},
                        {"minutes_per_million_cycles", minutes_per_million},
                        {"histogram", as_json(result.times)},
                        {"scripts", nlohmann::json::array()},
                        {"first_violation", nullptr},
                        {"verdict", result.held() ? "HELD" : "VIOLATED"}};
  add_violations(result.violations, result.watches_system_calls, all);
  if (predicted) {
    all["predicted_over_instructions"] = as_json(*predicted);
    all["instructions_max"] = predicted->heaviest_instructions;
  }
  for (const ScriptResult& script : result.scripts) {
    all["scripts"].push_back(as_json(script));
  }
  all["statuses"] = statuses_json(result.counts.by_status);
  if (result.first_violation) {
    all["first_violation"] = {{"script", name(result.first_violation->script)},
                              {"cycle", result.first_violation->cycle},
                              {"seed", options.seed},
                              {"replay", replay()}};
  }
  return all;
}

void StressReport::print() const {
  print_verdict();
  fmt::print(
      "{}: {} cycles, seed {}, at most {} contacts, {} cached factors; arena {} bytes, opened in {:.1f}, created in "
      "{:.1f} ms\n\n",
      model, result.cycles, options.seed, options.contacts, options.factors, result.arena_bytes, open_ms,
      result.create_ms);
  print_scripts(result.scripts);
  fmt::print("\n");
  print_counts(result);
  fmt::print("worst work {} of {} declared units: declared {:.2f} times the worst\n", result.counts.worst_work,
             result.declared_work, declared_over_worst());
  if (predicted) {
    fmt::print("instructions of the heaviest kind of step {}\n", predicted->heaviest_instructions);
    print_predicted(*predicted);
  } else {
    fmt::print("instructions not counted (--instructions)\n");
  }
  print_if_unwatched(result.watches_system_calls);
  fmt::print("largest relative step of the forces by a change of level alone {:.3g}\n", result.force_step_max);
  fmt::print(
      "largest step of a moving tool's force at a tenth, a quarter of the finest level's work: {:.2f}, {:.2f} times "
      "the finest level's; {:.2f} where contacts go before others come\n",
      starved.tenth, starved.quarter, starved.apart);
  fmt::print("digest {:016x}; {:.1f} minutes per million cycles\n\n", result.digest, minutes_per_million);
  print_histogram(result.times);
}

void StressReport::print_verdict() const {
  fmt::print("{}\n", verdict());
  if (result.first_violation) {
    fmt::print("first in script {}, seed {}, cycle {}; again with\n  {}\n", name(result.first_violation->script),
               options.seed, result.first_violation->cycle, replay());
  }
  fmt::print("{}\n", time.text("step"));
}

}  // namespace greenloop
