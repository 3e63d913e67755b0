#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "formats/trajectory/trajectory_file.hpp"
#include "formats/write/impulse_response.hpp"
#include "offline/reduce/phase_portrait.hpp"
#include "offline/reduce/reduced_frames.hpp"
#include "offline/reduce/replay.hpp"

namespace greenloop::offline {

/// What a model of trajectories is asked for.
struct ImpulseModelGoal {
  ReductionGoal reduction;
  double quantisation = 0.01;        ///< root mean square error of quantised displacements, relative, beside truncation
  double dead_end = 0.5;             ///< an orbit goes on within this distance, of the largest |q_u|, or is taken out
  std::optional<double> blend_rate;  ///< lambda, 1/s; none: default_blend_rate
  double rate = 0;                   ///< Hz, of the loop; 0: a step for each frame
  std::optional<std::vector<RigidShape>> rigid = {};  ///< penetrations are counted, with these; none: they are not
};

/// A model before encoding, and what it cost.
struct ImpulseModel {
  ImpulseResponseData data;             ///< without provenance
  std::vector<double> singular_values;  ///< m, of all modes that were found
  double unread = 0;                    ///< m, as of ReducedFrames
  std::vector<DeadEnd> dead_ends;
  std::vector<double> replay_errors;               ///< rising; none if no orbit is held out
  std::optional<ReplayPenetrations> penetrations;  ///< of the same orbits, if the goal asks for it
};

/// 1/s: of nine orbits in ten, all but 5 % of a difference has died out when they end; and no more than a fifth of it
/// dies out in a time step, so that a frame does not show it. Needs orbits.
[[nodiscard]] double default_blend_rate(const PhasePortrait& portrait, double time_step);

/// From trajectories to a model: reduction, phase portrait, continuation, references, quantisation, replay of what is
/// held out. Throws std::runtime_error saying what to mend. Memory: that of the reduction, and some numbers for each
/// row and mode. progress: part of the reading.
[[nodiscard]] ImpulseModel build_impulse_model(const TrajectoryFile& file, const ImpulseModelGoal& goal,
                                               const std::function<void(double)>& progress);

}  // namespace greenloop::offline
