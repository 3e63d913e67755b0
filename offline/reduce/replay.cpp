#include "offline/reduce/replay.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

namespace greenloop::offline {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Plays rows of a portrait and blends: x(t) = orbit(t) + (x_now - x_start) exp(-lambda t).
class Replay {
 public:
  Replay(const PhasePortrait& portrait, std::size_t orbit, VectorXd offset, double decay)
      : portrait_(portrait),
        orbit_(orbit),
        row_(Index{portrait.orbits[orbit].first_row} + 1),
        offset_(std::move(offset)),
        decay_(decay) {}

  [[nodiscard]] VectorXd position() const { return portrait_.position.col(row_) + offset_; }

  void pass() {
    offset_ *= decay_;
    const layout::OrbitRecord& orbit = portrait_.orbits[orbit_];
    if (row_ + 1 < Index{orbit.first_row} + orbit.rows) {
      ++row_;
    } else if (orbit.next_orbit != layout::none) {
      offset_ += portrait_.position.col(row_) - portrait_.position.col(orbit.next_row);
      orbit_ = orbit.next_orbit;
      row_ = Index{orbit.next_row} + 1;
    }
  }

 private:
  const PhasePortrait& portrait_;
  std::size_t orbit_;
  Index row_;
  VectorXd offset_;
  double decay_;
};

/// The orbit of the impulse whose start is nearest to a state.
std::size_t nearest_orbit(const PhasePortrait& portrait, std::uint32_t impulse, const VectorXd& position,
                          const VectorXd& velocity) {
  std::size_t nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 1; k < portrait.orbits.size(); ++k) {
    if (portrait.orbits[k].impulse != impulse) continue;
    const Index start = Index{portrait.orbits[k].first_row} + 1;
    const double square = (position - portrait.position.col(start)).squaredNorm() +
                          portrait.balance * portrait.balance * (velocity - portrait.velocity.col(start)).squaredNorm();
    if (square < least) {
      least = square;
      nearest = k;
    }
  }
  return nearest;
}

/// A frame of a held-out orbit, in coordinates.
struct ReplayedFrame {
  std::uint64_t frame = 0;  ///< of the trajectories
  VectorXd simulated, replayed;
  double left_out = 0;  ///< m^2, of what was simulated
};

/// Plays the first half second of a held-out orbit beside its simulation; the start is left out.
template <class Visit>
void replay_orbit(const TrajectoryFile& file, const TrajectoryOrbit& orbit, const ReducedFrames& reduced,
                  const PhasePortrait& portrait, double blend_rate, const Visit& visit) {
  const double step = file.scene().time_step;
  const auto frames = std::min(orbit.frames, static_cast<std::uint64_t>(std::lround(replay_seconds / step)) + 1);
  const ProjectedFrames truth = project_frames(file, {{orbit.first_frame, frames}}, reduced);
  VectorXd before = reduced.rest;
  if (orbit.previous_frame >= 0) {
    before = project_frames(file, {{static_cast<std::uint64_t>(orbit.previous_frame), 1}}, reduced).coordinates.col(0);
  }
  const VectorXd start = truth.coordinates.col(0);
  const std::size_t nearest = nearest_orbit(portrait, orbit.impulse, start, (start - before) / step);
  const Index first = Index{portrait.orbits[nearest].first_row} + 1;
  Replay replay(portrait, nearest, start - portrait.position.col(first), std::exp(-blend_rate * step));
  for (std::uint64_t k = 1; k < frames; ++k) {
    replay.pass();
    visit(ReplayedFrame{orbit.first_frame + k, truth.coordinates.col(static_cast<Index>(k)), replay.position(),
                        truth.left_out[k]});
  }
}

double replay_error(const TrajectoryFile& file, const TrajectoryOrbit& orbit, const ReducedFrames& reduced,
                    const PhasePortrait& portrait, double blend_rate) {
  double difference = 0, size = 0;
  replay_orbit(file, orbit, reduced, portrait, blend_rate, [&](const ReplayedFrame& at) {
    difference += (at.simulated - at.replayed).squaredNorm() + at.left_out;
    size += (at.simulated - reduced.rest).squaredNorm() + at.left_out;
  });
  return size > 0 ? std::sqrt(difference / size) : 0;
}

}  // namespace

std::vector<double> replay_errors(const TrajectoryFile& file, const ReducedFrames& reduced,
                                  const PhasePortrait& portrait, double blend_rate) {
  std::vector<double> errors;
  for (const TrajectoryOrbit& orbit : file.scene().orbits) {
    if (orbit.held_out) errors.push_back(replay_error(file, orbit, reduced, portrait, blend_rate));
  }
  std::sort(errors.begin(), errors.end());
  return errors;
}

ReplayPenetrations replay_penetrations(const TrajectoryFile& file, const ReducedFrames& reduced,
                                       const PhasePortrait& portrait, double blend_rate,
                                       const std::vector<RigidShape>& rigid) {
  constexpr double between = 0.05;  // s
  const auto every = std::max(1L, std::lround(between / file.scene().time_step));
  PenetrationCounter simulated(file.scene().triangles, rigid), replayed(file.scene().triangles, rigid);
  std::vector<float> frame(file.scene().rest.size());
  const Eigen::Map<const Eigen::VectorXf> shape(reduced.shape.data(), static_cast<Index>(reduced.shape.size()));
  for (const TrajectoryOrbit& orbit : file.scene().orbits) {
    if (!orbit.held_out) continue;
    replay_orbit(file, orbit, reduced, portrait, blend_rate, [&](const ReplayedFrame& at) {
      if ((at.frame - orbit.first_frame) % static_cast<std::uint64_t>(every) != 0) return;
      file.read_frames(at.frame, 1, frame);
      simulated.add(frame);
      Eigen::Map<Eigen::VectorXf>(frame.data(), shape.size()) = shape + reduced.modes * at.replayed.cast<float>();
      replayed.add(frame);
    });
  }
  return {simulated.count(), replayed.count()};
}

double quantile(const std::vector<double>& rising, double part) {
  const auto place = static_cast<std::size_t>(std::ceil(part * static_cast<double>(rising.size())));
  return rising[std::max<std::size_t>(place, 1) - 1];
}

}  // namespace greenloop::offline
