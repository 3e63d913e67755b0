#include <fmt/format.h>

#include "rt_tests/stress/elastic_stress.hpp"

namespace greenloop {
namespace {

using nlohmann::json;

json as_json(const ScriptOutcome<ElasticScriptKind, ElasticCounts>& script) {
  nlohmann::json all = script_json(script);
  all["overflows"] = script.counts.of(Status::held_overflow);
  all["multigrid_cycles"] = script.counts.multigrid_cycles;
  all["residual_mean"] = script.counts.mean_residual();
  all["residual_max"] = script.counts.residual;
  all["displacement_max"] = script.counts.farthest;
  return all;
}

json as_json(const ElasticCounts& counts) {
  return {{"cycles", counts.multigrid_cycles},
          {"residual_mean", counts.mean_residual()},
          {"residual_max", counts.residual},
          {"overflows", counts.of(Status::held_overflow)}};
}

}  // namespace

template <>
json ElasticStressReport::json() const {
  nlohmann::json all = report_json(*this);
  all["multigrid"] = as_json(result.counts);
  for (const auto& script : result.scripts) all["scripts"].push_back(as_json(script));
  return all;
}

template <>
void ElasticStressReport::print() const {
  print_opening(*this, "a multigrid model");
  fmt::print("{:<8} {:>9} {:>9} {:>9} {:>9} {:>9} {:>10} {:>10} {:>10} {:>9}\n", "script", "cycles", "answered",
             "coarser", "refused", "overflows", "residual", "at most", "farthest m", "worst us");
  for (const auto& s : result.scripts) {
    fmt::print("{:<8} {:>9} {:>9} {:>9} {:>9} {:>9} {:>10.1e} {:>10.1e} {:>10.3g} {:>9.0f}\n", name(s.kind), s.cycles,
               s.counts.answers(), s.counts.of(Status::coarser), s.cycles - s.counts.answers(),
               s.counts.of(Status::held_overflow), s.counts.mean_residual(), s.counts.residual, s.counts.farthest,
               s.worst_us);
  }
  print_work(*this);
  print_ending(*this);
}

}  // namespace greenloop
