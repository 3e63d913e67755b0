#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "offline/scene/sheet.hpp"

namespace greenloop::offline {

/// A velocity that the support of a body suddenly has in addition, or that of sheets from now on
/// (docs/simulating.md).
struct SupportImpulse {
  std::string name;                               ///< printable ASCII, 1 to 31 letters, none twice
  double speed = 0;                               ///< m/s
  Eigen::Vector3d direction{1, 0, 0};             ///< of any length but 0
  double turning = 0;                             ///< 1/s, about the y axis, from now on; only of sheets
  std::optional<double> longest;                  ///< s, of its orbits; none: as of all others
  std::optional<std::vector<std::string>> after;  ///< what it may follow: names of impulses, "rest"; none: everything

  [[nodiscard]] Eigen::Vector3d velocity() const { return speed * direction.normalized(); }
};

/// How the body of a scene moves on its own, and what of that is to be played.
struct Simulation {
  double time_step = 0;          ///< s, between frames
  bool corotational = true;      ///< strain: large rotations
  int level = 0;                 ///< of the remeshed surface: its vertices bound the tetrahedra; finer ones are shown
  double mass_damping = 0;       ///< Rayleigh's alpha, 1/s
  double stiffness_damping = 0;  ///< and beta, s
  double newmark_gamma = 0.5;    ///< 0.5..1
  double rest = 0;               ///< m, less is not seen
  bool coverage = false;         ///< starts where nothing near was played, else at random
  std::uint32_t orbits = 0;
  std::uint32_t held_out = 0;  ///< more orbits, to measure on
  double shortest = 0;         ///< s, of an orbit
  double longest = 0;          ///< s
  double to_rest = 0;          ///< share of the orbits that end at rest
  double longest_to_rest = 0;  ///< s, of these
  std::uint64_t seed = 1;
  double replay_goal = 0;      ///< stop once held-out orbits replay with such a median error; 0: after all orbits
  std::optional<Sheet> sheet;  ///< none: an elastic solid
  std::vector<SupportImpulse> impulses;  ///< at least one
  std::string trajectories_name;         ///< of the file to write, as the scene says; empty: it does not say
  std::filesystem::path trajectories;    ///< seen from the working directory
};

/// Orbits that a scene may ask for.
inline constexpr int most_orbits = 100'000;

/// Which impulse may follow which: [impulses + 1][impulses], the last row for those that may follow rest.
[[nodiscard]] std::vector<std::uint8_t> successions(const Simulation& simulation);

}  // namespace greenloop::offline
