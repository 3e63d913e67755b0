#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "runtime/algebra/double3.hpp"

namespace greenloop {

// What keeps a loop with a device and a hand from making energy of its own: docs/contact.md, "A hand in the loop".

/// A device that holds its force for a period, and how late that force is.
struct SampledLoop {
  double period = 0;   ///< s
  double delay = 0;    ///< s, from a position's measurement to its force, beyond the hold
  double damping = 0;  ///< N s/m, of the device itself
};

/// The largest stiffness, N/m, that such a loop may render with a virtual damping, N s/m, and be passive against any
/// hand: damping > stiffness (period / 2 + delay) + |virtual damping| (Colgate & Schenkel 1997, with their delay of
/// half a period made longer). Zero if there is none. Constant work.
[[nodiscard]] double passive_stiffness(const SampledLoop& loop, double virtual_damping = 0) noexcept;

/// The stiffness, N/m, of a virtual coupling between device and tool in series with which a body is as soft as `limit`
/// (Colgate, Stanley & Brown 1995): infinite if the body, N/m, is softer by itself. `limit` is one for all bodies.
/// ContactBody::ToolInput::compliance takes its inverse. Constant work.
[[nodiscard]] double coupling_stiffness(double body, double limit) noexcept;

/// Keeps a sampled loop passive by what it observes: the energy that has gone through the device to the hand may not
/// exceed what came from it and a reserve (Hannaford & Ryu 2002, as a tank: Franken et al. 2011). Forces that would
/// draw more are braked along the motion. It stands where forces are rendered, so that what is late, lost or held is
/// accounted for as it is felt. A device has one tank for all its handles, as what one puts into a body may come out at
/// another; a value without pointers.
class EnergyTank {
 public:
  static constexpr std::uint32_t most_ports = 16;

  struct Settings {
    bool enabled = true;       ///< false: it only observes
    double period = 1e-3;      ///< s
    double reserve = 1e-5;     ///< J, what the hand may get beyond what it gave
    double most_damping = 10;  ///< N s/m, with which it is braked at most: below a device's mass over the period
  };

  EnergyTank() = default;
  explicit EnergyTank(const Settings& settings) noexcept : settings_(settings), level_(settings.reserve) {}

  /// One sample. position: [ports] where the handles are, m, at most most_ports, as many in each sample. force: [ports]
  /// N on the hands, what is wanted, becomes what is to be rendered until the next sample. stored: J, what the contacts
  /// store now: more than that and the reserve the tank does not keep, so that what friction took away does not pay for
  /// a later growth. Numbers that are not finite: the force is zero and nothing is accounted for. For the loop; work:
  /// linear in the ports.
  void step(std::span<const Double3> position, std::span<Double3> force, double stored) noexcept;

  [[nodiscard]] double level() const noexcept { return level_; }          ///< J, below 0: overdrawn
  [[nodiscard]] double lowest() const noexcept { return lowest_; }        ///< J, the least level so far, at most 0
  [[nodiscard]] double drained() const noexcept { return drained_; }      ///< J, by braking so far
  [[nodiscard]] double delivered() const noexcept { return delivered_; }  ///< J, net, to the hands so far

 private:
  Settings settings_;
  double level_ = 0;
  double lowest_ = 0;
  double drained_ = 0;
  double delivered_ = 0;
  std::uint32_t ports_ = 0;
  std::array<Double3, most_ports> position_{};
  std::array<Double3, most_ports> force_{};    ///< rendered since the last sample
  std::array<Double3, most_ports> braking_{};  ///< their part that brakes
};

}  // namespace greenloop
