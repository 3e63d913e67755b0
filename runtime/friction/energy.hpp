#pragma once

#include <span>

#include "runtime/vec.hpp"

namespace greenloop {

/// What a contact point did in a step. A point that was no candidate in the step before had no force then.
struct EnergyContact {
  Vec4 normal;      ///< unit, out of the tool
  Vec4 force;       ///< of the tool on the body, N
  Vec4 last_force;  ///< at the step before
  Vec4 shift;       ///< displacement by all contact forces, m
  Vec4 last_shift;
  Vec4 way;  ///< of the tool's point there in this step, m
};

/// The energy of the contacts since the beginning, J, in double precision: stored + dissipated + lost - in is
/// `generated`. Forces count as they are at the end of a step, as the contact problem finds them: then friction and
/// what a step loses are never negative where the contact law holds, and so the tools never get out more than they put
/// in.
struct EnergyAccount {
  double in = 0;          ///< work of the tools on the body
  double stored = 0;      ///< 1/2 f^T A f, what the contact forces strain the body with
  double dissipated = 0;  ///< by friction
  double lost = 0;        ///< by going in steps: 1/2 of each change of force times its change of displacement, and what
                          ///< forces would have done in gaps that closed in the step

  /// What does not add up: rounding, and forces of points that were dropped.
  [[nodiscard]] double generated() const noexcept { return stored + dissipated + lost - in; }

  /// Adds a step. contacts: all with a force now or at the step before. For the loop, linear in them.
  void add(std::span<const EnergyContact> contacts) noexcept;
};

/// A device that holds its force for a period, and how late that force is.
struct SampledLoop {
  double period = 0;   ///< s
  double delay = 0;    ///< s, from a position's measurement to its force, beyond the hold
  double damping = 0;  ///< N s/m, of the device itself
};

/// The largest stiffness, N/m, that such a loop may render with a virtual damping, N s/m, and be passive against any
/// hand: damping > stiffness (period / 2 + delay) + |virtual damping| (Colgate & Schenkel 1997, with their delay of
/// half a period made longer). Zero if there is none.
[[nodiscard]] double passive_stiffness(const SampledLoop& loop, double virtual_damping = 0) noexcept;

/// The stiffness, N/m, of a virtual coupling between device and tool in series with which a body of any stiffness is as
/// soft as `limit`, or softer: `limit` itself. With one of a known stiffness it may be stiffer; infinite if that is
/// below the limit.
[[nodiscard]] double coupling_stiffness(double body, double limit) noexcept;

/// Keeps a sampled loop passive by what it observes: the energy that has gone through the device to the hand may not
/// exceed what came from it and a reserve (Hannaford & Ryu 2002, as a tank: Franken et al. 2011). A force that would
/// draw more is braked along the motion.
class EnergyTank {
 public:
  struct Settings {
    bool enabled = true;
    double period = 1e-3;      ///< s
    double reserve = 1e-5;     ///< J, what the hand may get beyond what it gave
    double most_damping = 10;  ///< N s/m, with which it is braked at most: below 2 device masses a period
  };

  EnergyTank() = default;
  explicit EnergyTank(const Settings& settings) noexcept : settings_(settings), level_(settings.reserve) {}

  /// One sample: where the device is, m, and what force on the hand is wanted, N; returns the force to render until the
  /// next. stored: J, what the contacts store now: more than that and the reserve the tank does not keep, so that what
  /// friction took away does not pay for a later growth. Not enabled, it only observes. For the loop, constant work.
  [[nodiscard]] Vec3 step(const Vec3& position, const Vec3& force, double stored) noexcept;

  [[nodiscard]] double level() const noexcept { return level_; }          ///< J, below 0: overdrawn
  [[nodiscard]] double drained() const noexcept { return drained_; }      ///< J, of braking so far
  [[nodiscard]] double delivered() const noexcept { return delivered_; }  ///< J, net, to the hand so far

 private:
  Settings settings_;
  double level_ = 0;
  double drained_ = 0;
  double delivered_ = 0;
  bool begun_ = false;
  Vec3 position_;
  Vec3 force_;    ///< rendered since the last sample
  Vec3 braking_;  ///< its part that brakes
};

}  // namespace greenloop
