#pragma once

#include <span>

#include "runtime/algebra/double3.hpp"

namespace greenloop {

/// What a contact point did in a step. A point that was no candidate in the step before had no force then.
struct EnergyContact {
  Double3 normal;      ///< unit, out of the tool
  Double3 force;       ///< of the tool on the body, N
  Double3 last_force;  ///< at the step before
  Double3 shift;       ///< displacement by all that acts, m
  Double3 last_shift;
  Double3 by_loads;  ///< the part of it that is there without contact forces, m
  Double3 last_by_loads;
  Double3 way;  ///< of the tool's point there in this step, m
};

/// The energy of the contacts since the beginning, J, in double precision: stored + dissipated + lost - in - from_loads
/// is `generated`. Forces count as they are at the end of a step, as the contact problem finds them: then friction and
/// what a step loses are never negative where the contact law holds, and so the tools never get out more than they put
/// in.
struct EnergyAccount {
  double in = 0;  ///< work of the tools on the body
  double from_loads =
      0;              ///< what loads that change, as gravity that turns, put in against the contact forces; < 0: out
  double stored = 0;  ///< 1/2 f^T A f, what the contact forces strain the body with
  double dissipated = 0;  ///< by friction
  double lost = 0;        ///< by going in steps: 1/2 of each change of force times its change of displacement, and what
                          ///< forces would have done in gaps that closed in the step

  /// What does not add up: rounding, and forces of points that were dropped.
  [[nodiscard]] double generated() const noexcept { return stored + dissipated + lost - in - from_loads; }

  /// Adds a step. contacts: all with a force now or at the step before. For the loop, linear in them.
  void add(std::span<const EnergyContact> contacts) noexcept;
};

}  // namespace greenloop
