#include <fmt/format.h>

#include "rt_tests/stress/tool_stress.hpp"
#include "sim_hw/control_loop/status_name.hpp"

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

double ratio(std::uint64_t declared, std::uint64_t worst) {
  return worst > 0 ? static_cast<double>(declared) / static_cast<double>(worst) : 0;
}

}  // namespace

double ToolStressReport::declared_over_worst() const {
  return ratio(result.declared.worst_work, result.counts.worst_work);
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
                          {"declared_over_worst", ratio(result.declared.touching_work, counts.worst_touching)},
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
  for (const auto& [name, number] : named(result.violations)) all[name] = number;
  if (!result.watches_system_calls) all["syscalls"] = nullptr;
  for (const ToolScriptResult& script : result.scripts) all["scripts"].push_back(as_json(script));
  for (std::size_t i = 0; i < statuses; ++i) all["statuses"][name(static_cast<Status>(i))] = counts.by_status[i];
  if (result.first_violation) {
    all["first_violation"] = {{"script", name(result.first_violation->script)},
                              {"cycle", result.first_violation->cycle},
                              {"what", result.first_violation->what},
                              {"seed", options.seed},
                              {"replay", replay()}};
  }
  return all;
}

void ToolStressReport::print() const {
  fmt::print("{}\n", verdict());
  if (result.first_violation) {
    fmt::print("first in script {}, seed {}, cycle {}: {}; again with\n  {}\n", name(result.first_violation->script),
               options.seed, result.first_violation->cycle, result.first_violation->what, replay());
  }
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
  fmt::print("\nsteps by status:");
  for (std::size_t i = 0; i < statuses; ++i) {
    if (result.counts.by_status[i] > 0) fmt::print("  {} {}", name(static_cast<Status>(i)), result.counts.by_status[i]);
  }
  const ContactBody::Requirement& declared = result.declared;
  fmt::print(
      "\nworst work {} of {} declared units, {:.2f} times the worst; of these finding contacts {} of {}, {:.2f}\n",
      result.counts.worst_work, declared.worst_work, declared_over_worst(), result.counts.worst_touching,
      declared.touching_work, ratio(declared.touching_work, result.counts.worst_touching));
  fmt::print("{} contacts with a force, {} of them slipping, friction over its cone by {:.1g} at most\n",
             result.counts.contacts, result.counts.slipping, result.counts.most_over_cone);
  if (!result.watches_system_calls) {
    fmt::print("system calls not watched: this kernel has no Syscall User Dispatch\n");
  }
  fmt::print("digest {:016x}; {:.1f} minutes per million cycles\n", result.digest, minutes_per_million);
}

}  // namespace greenloop
