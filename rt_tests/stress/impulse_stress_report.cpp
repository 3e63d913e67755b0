#include <fmt/format.h>

#include <string>

#include "rt_tests/stress/impulse_stress.hpp"
#include "rt_tests/stress/report_parts.hpp"

namespace greenloop {
namespace {

using nlohmann::json;

json as_json(const ImpulseScriptResult& script) {
  const ImpulseCounts& counts = script.counts;
  return {{"name", name(script.kind)},
          {"cycles", script.cycles},
          {"answered", counts.answers()},
          {"coarser", counts.of(Status::coarser)},
          {"refused", script.cycles - counts.answers()},
          {"impulses", counts.entered},
          {"blending", counts.blending},
          {"continued", counts.continued},
          {"worst_work", counts.worst_work},
          {"worst_us", script.worst_us},
          {"energy_over_bound", counts.most_energy_share},
          {"digest", fmt::format("{:016x}", script.digest)}};
}

json as_json(const ImpulseCounts& counts, double energy_bound) {
  return {{"impulses", counts.entered},     {"blending", counts.blending},
          {"continued", counts.continued},  {"illegal", counts.of(Status::held_illegal_impulse)},
          {"blend_max", counts.most_blend}, {"energy_max", counts.most_energy},
          {"energy_bound", energy_bound},   {"energy_over_bound", counts.most_energy_share}};
}

}  // namespace

std::string ImpulseStressReport::replay() const {
  if (!result.first_violation) return {};
  return fmt::format("greenloop-stress {} --seed {} --script {} --cycles {}", model, options.seed,
                     name(result.first_violation->script), result.first_violation->cycle + 1);
}

json ImpulseStressReport::json() const {
  const ImpulseCounts& counts = result.counts;
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
                        {"motion", as_json(counts, result.energy_bound)},
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
  for (const ImpulseScriptResult& script : result.scripts) all["scripts"].push_back(as_json(script));
  all["statuses"] = statuses_json(counts.by_status);
  if (result.first_violation) {
    all["first_violation"] = violation_json(*result.first_violation, options.seed, replay());
  }
  return all;
}

void ImpulseStressReport::print() const {
  fmt::print("{}\n", verdict());
  if (result.first_violation) print_violation(*result.first_violation, options.seed, replay());
  fmt::print("{}\n", time.text("step"));
  const double seconds = static_cast<double>(result.cycles) / rate;
  fmt::print(
      "{}: {} cycles of motions, {:.0f} s at {:.0f} Hz, seed {}; arena {} bytes, opened in {:.1f}, created in "
      "{:.2f} ms\n\n",
      model, result.cycles, seconds, rate, options.seed, result.declared.bytes, open_ms, result.create_ms);
  fmt::print("{:<8} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>10} {:>9} {:>7}\n", "script", "cycles", "answered",
             "coarser", "refused", "impulses", "blending", "continued", "worst work", "worst us", "energy");
  for (const ImpulseScriptResult& s : result.scripts) {
    fmt::print("{:<8} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>10} {:>9.0f} {:>6.1f}%\n", name(s.kind), s.cycles,
               s.counts.answers(), s.counts.of(Status::coarser), s.cycles - s.counts.answers(), s.counts.entered,
               s.counts.blending, s.counts.continued, s.counts.worst_work, s.worst_us,
               100 * s.counts.most_energy_share);
  }
  fmt::print("\n");
  const ImpulseCounts& counts = result.counts;
  print_statuses(counts.by_status);
  fmt::print("worst work {} of {} declared units: declared {:.2f} times the worst\n", counts.worst_work,
             counts.declared_work, counts.declared_over_worst());
  if (predicted) {
    fmt::print("instructions of the heaviest kind of step {}\n", predicted->heaviest_instructions);
    print_ratios(predicted->ways, predicted->all);
  }
  fmt::print("largest difference that had to die out {:.3g} m; energy of the state at most {:.3g} m^2, bound {:.3g}\n",
             counts.most_blend, counts.most_energy, result.energy_bound);
  fmt::print("{} limits that are none were refused\n", result.wrong_limits);
  print_if_unwatched(result.watches_system_calls);
  fmt::print("digest {:016x}; {:.2f} minutes per million cycles\n\n", result.digest, minutes_per_million);
  print_histogram(result.times);
}

}  // namespace greenloop
