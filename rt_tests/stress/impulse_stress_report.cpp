#include <fmt/format.h>

#include "rt_tests/stress/impulse_stress.hpp"

namespace greenloop {
namespace {

using nlohmann::json;

json as_json(const ScriptOutcome<ImpulseScriptKind, ImpulseCounts>& script) {
  nlohmann::json all = script_json(script);
  all["impulses"] = script.counts.entered;
  all["blending"] = script.counts.blending;
  all["continued"] = script.counts.continued;
  all["energy_over_bound"] = script.counts.most_energy_share;
  return all;
}

json as_json(const ImpulseCounts& counts, double energy_bound) {
  return {{"impulses", counts.entered},     {"blending", counts.blending},
          {"continued", counts.continued},  {"illegal", counts.of(Status::held_illegal_impulse)},
          {"blend_max", counts.most_blend}, {"energy_max", counts.most_energy},
          {"energy_bound", energy_bound},   {"energy_over_bound", counts.most_energy_share}};
}

}  // namespace

template <>
json ImpulseStressReport::json() const {
  nlohmann::json all = report_json(*this);
  all["motion"] = as_json(result.counts, result.energy_bound);
  for (const auto& script : result.scripts) all["scripts"].push_back(as_json(script));
  return all;
}

template <>
void ImpulseStressReport::print() const {
  print_opening(*this, "motions");
  fmt::print("{:<8} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>10} {:>9} {:>7}\n", "script", "cycles", "answered",
             "coarser", "refused", "impulses", "blending", "continued", "worst work", "worst us", "energy");
  for (const auto& s : result.scripts) {
    fmt::print("{:<8} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>10} {:>9.0f} {:>6.1f}%\n", name(s.kind), s.cycles,
               s.counts.answers(), s.counts.of(Status::coarser), s.cycles - s.counts.answers(), s.counts.entered,
               s.counts.blending, s.counts.continued, s.counts.worst_work, s.worst_us,
               100 * s.counts.most_energy_share);
  }
  print_work(*this);
  fmt::print("largest difference that had to die out {:.3g} m; energy of the state at most {:.3g} m^2, bound {:.3g}\n",
             result.counts.most_blend, result.counts.most_energy, result.energy_bound);
  print_ending(*this);
}

}  // namespace greenloop
