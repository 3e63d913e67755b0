#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "formats/trajectory/trajectory_file.hpp"
#include "offline/progress.hpp"
#include "offline/simulate/simulator.hpp"

namespace greenloop::offline {

enum class Sampling : std::uint8_t {
  random,    ///< each orbit interrupts the one before by a legal impulse (James & Fatahalian 2003, section 3.5)
  coverage,  ///< each starts where the nearest start of the same impulse is farthest, of all states to choose from
};

/// Which orbits to play.
struct SamplingPlan {
  Sampling sampling = Sampling::coverage;
  std::uint32_t orbits = 0;    ///< for the model
  std::uint32_t held_out = 0;  ///< played at random before these, to measure replay on
  double shortest = 0;         ///< s, before an orbit may be interrupted
  double longest = 0;          ///< s, of an orbit that is not played to rest
  double to_rest = 0;          ///< share of the orbits that are, 0..1
  double longest_to_rest = 0;  ///< s, of these
  std::uint64_t seed = 1;
  std::vector<std::optional<double>> longest_of = {};  ///< s, of the orbits of an impulse; fewer, none: as above
  double replay_goal = 0;  ///< stop before `orbits` once the median replay error of held-out orbits is below; 0: do not
};

/// A file with room for the plan's orbits.
[[nodiscard]] TrajectoryRoom room_for(const SamplingPlan& plan, double time_step);

/// Rest positions, triangles, time step of a simulator; impulses and successions of the caller's.
[[nodiscard]] TrajectoryScene describe(Simulator& simulator, std::vector<Impulse> impulses,
                                       std::vector<std::uint8_t> successions, std::string provenance);

/// Plays what the file lacks of the plan's orbits. `states`: see StateFile; 4 states an orbit. What is to come follows
/// from the plan, the simulator and the orbits that are whole, so that a run that was killed goes on with the same
/// bits. An impulse may follow another as the file's successions say; where none may, the next orbit starts at rest.
/// The distance of two states is that of their displacements, projected to 24 random coordinates, and of their
/// velocities, balanced as the paper does (section 2.3.2). Returns the median relative error, over half a second at
/// most, of held-out orbits replayed in these coordinates by the orbits for the model; none: nothing is held out.
/// Throws what simulator and file do.
std::optional<double> sample(Simulator& simulator, const SamplingPlan& plan, TrajectoryWriter& file,
                             const std::filesystem::path& states, const Progress& progress = {});

}  // namespace greenloop::offline
