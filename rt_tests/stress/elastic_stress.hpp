#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <vector>

#include "rt_tests/stress/elastic_stress_script.hpp"
#include "rt_tests/stress/scripted_stress.hpp"
#include "runtime/multigrid.hpp"

namespace greenloop {

using ElasticStressOptions = ScriptedStressOptions<ElasticScriptKind, Multigrid::Limits>;

/// Steps of some cycles.
struct ElasticCounts : StepCounts {
  std::uint64_t multigrid_cycles = 0;
  double residual_sum = 0, residual = 0;  ///< relative: of all answers, and the largest
  double farthest = 0;                    ///< m, largest displacement

  [[nodiscard]] double mean_residual() const;
  void add(const ElasticCounts& other);
};

using ElasticStressResult = ScriptedStressResult<ElasticScriptKind, ElasticCounts, Multigrid::Requirement>;

/// Runs an ElasticStressScript of every kind on bodies of `model`, every step with the guards of sim_hw/guard armed,
/// and checks each: no work beyond its budget, refused by its name what is wrong and nothing else, answers finite,
/// buffers that a refused step leaves, no state that is not finite but by what is huge, and a twin that never was given
/// what was refused: it is where the body is to the bit. Limits that are none must be refused before. Throws
/// std::runtime_error if no body can be created.
[[nodiscard]] ElasticStressResult run_elastic_stress(const Model& model, const ElasticStressOptions& options);

/// The same steps without guards, and at last the heaviest kind: all loads and holds, all answers, eight cycles.
[[nodiscard]] std::vector<ReportedStep> run_elastic_plainly(const Model& model, const ElasticStressOptions& options);

using ElasticStressReport = ScriptedStressReport<ElasticStressOptions, ElasticStressResult>;
template <>
nlohmann::json ElasticStressReport::json() const;
template <>
void ElasticStressReport::print() const;

}  // namespace greenloop
