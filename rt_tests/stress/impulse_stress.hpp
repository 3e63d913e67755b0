#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <vector>

#include "rt_tests/stress/impulse_stress_script.hpp"
#include "rt_tests/stress/scripted_stress.hpp"
#include "runtime/impulse_response.hpp"

namespace greenloop {

using ImpulseStressOptions =
    ScriptedStressOptions<ImpulseScriptKind, ImpulseResponse::Limits>;  // limits: of all scripts but `paces`

/// Steps of some cycles.
struct ImpulseCounts : StepCounts {
  std::uint64_t entered = 0;     ///< impulses that were followed
  std::uint64_t blending = 0;    ///< of these, while an earlier difference was left
  std::uint64_t continued = 0;   ///< steps in which an orbit went on in another
  double most_blend = 0;         ///< m, largest difference that blending had to take out
  double most_energy = 0;        ///< m^2, largest |q_u|^2 + rho^2 |q_v|^2 of the bodies of the model's limits
  double most_energy_share = 0;  ///< the largest, of any body, over its bound

  void add(const ImpulseCounts& other);
};

struct ImpulseStressResult : ScriptedStressResult<ImpulseScriptKind, ImpulseCounts, ImpulseResponse::Requirement> {
  double energy_bound = 0;  ///< m^2, of the bodies of the model's limits
};

/// Runs an ImpulseStressScript of every kind on bodies of `model`, every step with the guards of sim_hw/guard armed,
/// and checks each: what_is_wrong says of it, the energy of the state against what `motion_bounds` says, buffers that a
/// refused step leaves, and a twin that never was given what was refused: it is in the same state to the bit. Limits
/// that are none, NaN, infinite, zero, huge, must be refused before. Throws std::runtime_error if no body can be
/// created.
[[nodiscard]] ImpulseStressResult run_impulse_stress(const Model& model, const ImpulseStressOptions& options);

/// The same steps without guards, and at last the heaviest kind: an impulse, all vertices and their velocities.
[[nodiscard]] std::vector<ReportedStep> run_impulses_plainly(const Model& model, const ImpulseStressOptions& options);

using ImpulseStressReport = ScriptedStressReport<ImpulseStressOptions, ImpulseStressResult>;
template <>
nlohmann::json ImpulseStressReport::json() const;
template <>
void ImpulseStressReport::print() const;

}  // namespace greenloop
