#pragma once

#include <vector>

#include "formats/trajectory/trajectory_file.hpp"
#include "offline/reduce/penetration.hpp"
#include "offline/reduce/phase_portrait.hpp"
#include "offline/reduce/reduced_frames.hpp"

namespace greenloop::offline {

/// How long held-out orbits are compared with their replay.
inline constexpr double replay_seconds = 0.5;

/// The relative displacement error of each held-out orbit's replay, rising: over its first half second, the root of the
/// summed squares of the difference to the simulation over that of the displacements from rest. The replay begins in
/// the held-out start, goes over to the orbit of the same impulse whose start is nearest, and lets the difference die
/// out (section 5.1), in double precision with exact modes; what the modes leave out of the simulation counts. Reads
/// the held-out frames once.
[[nodiscard]] std::vector<double> replay_errors(const TrajectoryFile& file, const ReducedFrames& reduced,
                                                const PhasePortrait& portrait, double blend_rate);

/// What is counted in held-out orbits as they were simulated, and as they are replayed.
struct ReplayPenetrations {
  PenetrationCount simulated, replayed;
};

/// Looks at a frame of each 50 ms of the first half second of each held-out orbit, as replay_errors plays it. Reads the
/// held-out frames twice.
[[nodiscard]] ReplayPenetrations replay_penetrations(const TrajectoryFile& file, const ReducedFrames& reduced,
                                                     const PhasePortrait& portrait, double blend_rate,
                                                     const std::vector<RigidShape>& rigid);

/// The least of rising values that a part of them does not exceed. Needs one at least.
[[nodiscard]] double quantile(const std::vector<double>& rising, double part);

}  // namespace greenloop::offline
