#include <fmt/format.h>

#include "rt_tests/stress/report_parts.hpp"
#include "rt_tests/stress/tool_stress.hpp"

namespace greenloop {
namespace {

using nlohmann::json;

json as_json(const ToolScriptResult& script) {
  const ToolCounts& counts = script.counts;
  return {{"name", name(script.kind)},
          {"cycles", script.cycles},
          {"answered", counts.answers()},
          {"coarser", counts.of(Status::coarser)},
          {"refused", script.cycles - counts.answers()},
          {"contacts", counts.contacts},
          {"slipping", counts.slipping},
          {"faults", counts.faults},
          {"left_out", counts.left_out},
          {"unfinished", counts.unfinished},
          {"worst_work", counts.worst_work},
          {"worst_touching", counts.worst_touching},
          {"worst_us", script.worst_us},
          {"digest", fmt::format("{:016x}", script.digest)}};
}

}  // namespace

double ToolStressReport::declared_over_worst() const {
  return declared_over(result.declared.worst_work, result.counts.worst_work);
}

std::string ToolStressReport::replay() const {
  if (!result.first_violation) return {};
  return fmt::format("greenloop-stress {} --tools --seed {} --script {} --cycles {} --contacts {} --factors {}", model,
                     options.seed, name(result.first_violation->script), result.first_violation->cycle + 1,
                     options.contacts, options.factors);
}

json ToolStressReport::json() const {
  const ToolCounts& counts = result.counts;
  nlohmann::json all = {{"model", model},
                        {"seed", options.seed},
                        {"contacts", options.contacts},
                        {"factors", options.factors},
                        {"cycles", result.cycles},
                        {"worst_work", counts.worst_work},
                        {"declared_work", result.declared.worst_work},
                        {"declared_over_worst", declared_over_worst()},
                        {"least_work", result.declared.least_work},
                        {"touching",
                         {{"worst_work", counts.worst_touching},
                          {"declared_work", result.declared.touching_work},
                          {"declared_over_worst", declared_over(result.declared.touching_work, counts.worst_touching)},
                          {"contacts", counts.contacts},
                          {"slipping", counts.slipping},
                          {"faults", counts.faults},
                          {"left_out", counts.left_out},
                          {"unfinished", counts.unfinished},
                          {"most_over_cone", counts.most_over_cone}}},
                        {"time", time},
                        {"time_verdict", time.word()},
                        {"digest", fmt::format("{:016x}", result.digest)},
                        {"create_ms", result.create_ms},
                        {"arena_bytes", result.declared.bytes},
                        {"minutes_per_million_cycles", minutes_per_million},
                        {"scripts", nlohmann::json::array()},
                        {"first_violation", nullptr},
                        {"verdict", result.held() ? "HELD" : "VIOLATED"}};
  add_violations(result.violations, result.watches_system_calls, all);
  for (const ToolScriptResult& script : result.scripts) all["scripts"].push_back(as_json(script));
  all["statuses"] = statuses_json(counts.by_status);
  if (result.first_violation) {
    all["first_violation"] = violation_json(*result.first_violation, options.seed, replay());
  }
  return all;
}

void ToolStressReport::print() const {
  fmt::print("{}\n", verdict());
  if (result.first_violation) print_violation(*result.first_violation, options.seed, replay());
  fmt::print("{}\n", time.text("step"));
  fmt::print("{}: {} cycles of tools, seed {}, at most {} contacts; arena {} bytes, created in {:.1f} ms\n\n", model,
             result.cycles, options.seed, options.contacts, result.declared.bytes, result.create_ms);
  fmt::print("{:<10} {:>9} {:>9} {:>9} {:>9} {:>11} {:>9} {:>10} {:>12} {:>12} {:>9}\n", "script", "cycles", "answered",
             "coarser", "refused", "contacts", "faults", "unfinished", "worst work", "touching", "worst us");
  for (const ToolScriptResult& s : result.scripts) {
    fmt::print("{:<10} {:>9} {:>9} {:>9} {:>9} {:>11} {:>9} {:>10} {:>12} {:>12} {:>9.0f}\n", name(s.kind), s.cycles,
               s.counts.answers(), s.counts.of(Status::coarser), s.cycles - s.counts.answers(), s.counts.contacts,
               s.counts.faults, s.counts.unfinished, s.counts.worst_work, s.counts.worst_touching, s.worst_us);
  }
  fmt::print("\n");
  print_statuses(result.counts.by_status);
  const ContactBody::Requirement& declared = result.declared;
  fmt::print("worst work {} of {} declared units, {:.2f} times the worst; of these finding contacts {} of {}, {:.2f}\n",
             result.counts.worst_work, declared.worst_work, declared_over_worst(), result.counts.worst_touching,
             declared.touching_work, declared_over(declared.touching_work, result.counts.worst_touching));
  fmt::print("{} contacts with a force, {} of them slipping, friction over its cone by {:.1g} at most\n",
             result.counts.contacts, result.counts.slipping, result.counts.most_over_cone);
  print_if_unwatched(result.watches_system_calls);
  fmt::print("digest {:016x}; {:.1f} minutes per million cycles\n", result.digest, minutes_per_million);
}

}  // namespace greenloop
