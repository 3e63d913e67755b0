#include "offline/reduce/impulse_model.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "offline/reduce/mode_quantisation.hpp"
#include "offline/reduce/replay.hpp"

namespace greenloop::offline {
namespace {

using Eigen::Index;

/// Frames of orbits that are not held out, and those before them.
std::vector<FrameRange> frames_to_build_from(const TrajectoryScene& scene) {
  std::vector<FrameRange> ranges;
  for (const TrajectoryOrbit& orbit : scene.orbits) {
    if (orbit.held_out) continue;
    ranges.push_back({orbit.first_frame, orbit.frames});
    if (orbit.previous_frame >= 0) ranges.push_back({static_cast<std::uint64_t>(orbit.previous_frame), 1});
  }
  return joined_ranges(std::move(ranges));
}

/// How far displacements are off without the modes from `mode` on.
struct Truncation {
  double rms = 0;    ///< relative to the root mean square of all rows
  double worst = 0;  ///< of the worst row, relative to that of the largest row
};

/// [modes + 1]
std::vector<Truncation> truncations(const PhasePortrait& portrait) {
  const Index modes = portrait.position.rows();
  std::vector<Truncation> result(static_cast<std::size_t>(modes) + 1);
  for (Index row = 0; row < portrait.rows(); ++row) {
    double square = portrait.left_out[static_cast<std::size_t>(row)];
    for (Index m = modes; m >= 0; --m) {
      if (m < modes) square += portrait.position(m, row) * portrait.position(m, row);
      Truncation& error = result[static_cast<std::size_t>(m)];
      error.rms += square;
      error.worst = std::max(error.worst, square);
    }
  }
  const Truncation whole = result.front();
  for (Truncation& error : result) {
    error.rms = std::sqrt(error.rms / whole.rms);
    error.worst = std::sqrt(error.worst / whole.worst);
  }
  return result;
}

/// Modes of a level: about a quarter of all, an even number, four at least.
Index group_size(Index modes) { return std::max<Index>(4, (modes + 7) / 8 * 2); }

std::vector<ModeGroupData> mode_groups(const QuantisedModes& quantised, const std::vector<Truncation>& errors) {
  const auto modes = static_cast<Index>(quantised.amplitudes.size());
  std::vector<ModeGroupData> groups;
  for (Index begin = 0; begin < modes; begin += group_size(modes)) {
    const Index end = std::min(begin + group_size(modes), modes);
    const auto take = [&](const std::vector<std::int16_t>& from, std::vector<std::int16_t>& to) {
      for (std::size_t at = 0; at < from.size(); at += static_cast<std::size_t>(modes)) {
        const auto first = from.begin() + static_cast<std::ptrdiff_t>(at);
        to.insert(to.end(), first + begin, first + end);
      }
    };
    ModeGroupData group;
    take(quantised.values, group.values);
    take(quantised.coordinates, group.coordinates);
    for (Index m = begin; m < end; ++m) {
      const auto error = static_cast<float>(errors[static_cast<std::size_t>(m) + 1].rms);
      group.amplitudes.push_back({quantised.amplitudes[static_cast<std::size_t>(m)], error});
    }
    group.counts.truncation_error = static_cast<float>(errors[static_cast<std::size_t>(end)].rms);
    group.counts.worst_error = static_cast<float>(errors[static_cast<std::size_t>(end)].worst);
    groups.push_back(std::move(group));
  }
  return groups;
}

layout::ImpulseRecord record_of(const Impulse& impulse) {
  layout::ImpulseRecord record{};
  std::memcpy(record.name, impulse.name.data(), std::min(impulse.name.size(), sizeof(record.name) - 1));
  for (std::size_t k = 0; k < 4; ++k) {
    record.initial[k] = static_cast<float>(impulse.initial[k]);
    record.persistent[k] = static_cast<float>(impulse.persistent[k]);
  }
  return record;
}

/// Root of the summed squares of all rows' displacements, m.
double size_of(const PhasePortrait& portrait) {
  double sum = portrait.position.squaredNorm();
  for (const double left_out : portrait.left_out) sum += left_out;
  return std::sqrt(sum);
}

layout::ImpulseInfo info_of(const TrajectoryScene& scene, const ReducedFrames& reduced, const PhasePortrait& portrait,
                            const ImpulseModelGoal& goal) {
  layout::ImpulseInfo info{};
  info.time_step = scene.time_step;
  info.rate = static_cast<float>(goal.rate > 0 ? goal.rate : 1 / scene.time_step);
  info.blend_rate = static_cast<float>(goal.blend_rate.value_or(default_blend_rate(portrait, scene.time_step)));
  info.velocity_balance = static_cast<float>(portrait.balance);
  std::copy_n(reduced.box_min, 3, info.box_min);
  std::copy_n(reduced.box_max, 3, info.box_max);
  const double values = static_cast<double>(portrait.rows()) * static_cast<double>(scene.vertices());
  info.displacement = static_cast<float>(size_of(portrait) / std::sqrt(values));
  info.source_rows = frame_count(reduced.ranges);
  return info;
}

}  // namespace

double default_blend_rate(const PhasePortrait& portrait, double time_step) {
  std::vector<double> seconds;
  for (std::size_t k = 1; k < portrait.orbits.size(); ++k) seconds.push_back((portrait.orbits[k].rows - 2) * time_step);
  std::sort(seconds.begin(), seconds.end());
  return std::min(3 / quantile(seconds, 0.1), 0.2 / time_step);
}

ImpulseModel build_impulse_model(const TrajectoryFile& file, const ImpulseModelGoal& goal,
                                 const std::function<void(double)>& progress) {
  const TrajectoryScene& scene = file.scene();
  const ReducedFrames reduced = reduce_frames(file, frames_to_build_from(scene), goal.reduction, progress);
  PhasePortrait portrait = phase_portrait(scene, reduced);
  const double limit = goal.dead_end * portrait.position.colwise().norm().maxCoeff();
  ImpulseModel model;
  model.dead_ends = continue_orbits(scene.impulses, limit, portrait);
  model.singular_values = reduced.singular_values;
  model.unread = reduced.unread;

  ImpulseResponseData& data = model.data;
  data.info = info_of(scene, reduced, portrait, goal);
  const double size = size_of(portrait);
  QuantisedModes quantised = quantise_within(reduced.modes, portrait.position, goal.quantisation * size);
  data.info.planes = quantised.planes;
  data.info.quantisation_error = static_cast<float>(quantised.error / size);
  data.groups = mode_groups(quantised, truncations(portrait));
  data.shape = reduced.shape;
  data.triangles = scene.triangles;
  data.quanta = std::move(quantised.quanta);
  for (const Impulse& impulse : scene.impulses) data.impulses.push_back(record_of(impulse));
  data.successions = scene.successions;
  data.orbits = portrait.orbits;
  data.references = nearest_references(portrait, scene.successions, scene.impulses.size());
  model.replay_errors = replay_errors(file, reduced, portrait, data.info.blend_rate);
  if (goal.rigid) {
    model.penetrations = replay_penetrations(file, reduced, portrait, data.info.blend_rate, *goal.rigid);
  }
  return model;
}

}  // namespace greenloop::offline
