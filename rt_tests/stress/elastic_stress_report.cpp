#include <fmt/format.h>

#include <string>

#include "rt_tests/stress/elastic_stress.hpp"
#include "rt_tests/stress/report_parts.hpp"

namespace greenloop {
namespace {

using nlohmann::json;

json as_json(const ElasticScriptResult& script) {
  const ElasticCounts& counts = script.counts;
  return {{"name", name(script.kind)},
          {"cycles", script.cycles},
          {"answered", counts.answers()},
          {"coarser", counts.of(Status::coarser)},
          {"refused", script.cycles - counts.answers()},
          {"overflows", counts.of(Status::held_overflow)},
          {"multigrid_cycles", counts.multigrid_cycles},
          {"residual_mean", counts.mean_residual()},
          {"residual_max", counts.residual},
          {"displacement_max", counts.farthest},
          {"worst_work", counts.worst_work},
          {"worst_us", script.worst_us},
          {"digest", fmt::format("{:016x}", script.digest)}};
}

json as_json(const ElasticCounts& counts) {
  return {{"cycles", counts.multigrid_cycles},
          {"residual_mean", counts.mean_residual()},
          {"residual_max", counts.residual},
          {"overflows", counts.of(Status::held_overflow)}};
}

}  // namespace

std::string ElasticStressReport::replay() const {
  if (!result.first_violation) return {};
  return fmt::format("greenloop-stress {} --seed {} --script {} --cycles {}", model, options.seed,
                     name(result.first_violation->script), result.first_violation->cycle + 1);
}

json ElasticStressReport::json() const {
  const ElasticCounts& counts = result.counts;
  nlohmann::json all = {{"model", model},
                        {"seed", options.seed},
                        {"rate", rate},
                        {"cycles", result.cycles},
                        {"virtual_seconds", static_cast<double>(result.cycles) / rate},
                        {"worst_work", counts.worst_work},
                        {"declared_work", counts.declared_work},
                        {"declared_over_worst", counts.declared_over_worst()},
                        {"least_work", result.declared.least_work},
                        {"predicted_over_instructions", nullptr},
                        {"instructions_max", nullptr},
                        {"multigrid", as_json(counts)},
                        {"wrong_limits", result.wrong_limits},
                        {"time", time},
                        {"time_verdict", time.word()},
                        {"digest", fmt::format("{:016x}", result.digest)},
                        {"open_ms", open_ms},
                        {"create_ms", result.create_ms},
                        {"arena_bytes", result.declared.bytes},
                        {"minutes_per_million_cycles", minutes_per_million},
                        {"histogram", greenloop::as_json(result.times)},
                        {"scripts", nlohmann::json::array()},
                        {"first_violation", nullptr},
                        {"verdict", result.held() ? "HELD" : "VIOLATED"}};
  add_violations(result.violations, result.watches_system_calls, all);
  if (predicted) {
    all["predicted_over_instructions"] = greenloop::as_json(*predicted);
    all["instructions_max"] = predicted->heaviest_instructions;
  }
  for (const ElasticScriptResult& script : result.scripts) all["scripts"].push_back(as_json(script));
  all["statuses"] = statuses_json(counts.by_status);
  if (result.first_violation) {
    all["first_violation"] = violation_json(*result.first_violation, options.seed, replay());
  }
  return all;
}

void ElasticStressReport::print() const {
  fmt::print("{}\n", verdict());
  if (result.first_violation) print_violation(*result.first_violation, options.seed, replay());
  fmt::print("{}\n", time.text("step"));
  const double seconds = static_cast<double>(result.cycles) / rate;
  fmt::print(
      "{}: {} cycles of a multigrid model, {:.1f} s at {:.0f} Hz, seed {}; arena {} bytes, opened in {:.1f}, created "
      "in {:.2f} ms\n\n",
      model, result.cycles, seconds, rate, options.seed, result.declared.bytes, open_ms, result.create_ms);
  fmt::print("{:<8} {:>9} {:>9} {:>9} {:>9} {:>9} {:>10} {:>10} {:>10} {:>9}\n", "script", "cycles", "answered",
             "coarser", "refused", "overflows", "residual", "at most", "farthest m", "worst us");
  for (const ElasticScriptResult& s : result.scripts) {
    fmt::print("{:<8} {:>9} {:>9} {:>9} {:>9} {:>9} {:>10.1e} {:>10.1e} {:>10.3g} {:>9.0f}\n", name(s.kind), s.cycles,
               s.counts.answers(), s.counts.of(Status::coarser), s.cycles - s.counts.answers(),
               s.counts.of(Status::held_overflow), s.counts.mean_residual(), s.counts.residual, s.counts.farthest,
               s.worst_us);
  }
  fmt::print("\n");
  const ElasticCounts& counts = result.counts;
  print_statuses(counts.by_status);
  fmt::print("nearest to its budget: {} of {} units, the budget {:.2f} times as much\n", counts.worst_work,
             counts.declared_work, counts.declared_over_worst());
  if (predicted) {
    fmt::print("instructions of the heaviest kind of step {}\n", predicted->heaviest_instructions);
    print_ratios(predicted->ways, predicted->all);
  }
  fmt::print("{} limits that are none were refused\n", result.wrong_limits);
  print_if_unwatched(result.watches_system_calls);
  fmt::print("digest {:016x}; {:.2f} minutes per million cycles\n\n", result.digest, minutes_per_million);
  print_histogram(result.times);
}

}  // namespace greenloop
