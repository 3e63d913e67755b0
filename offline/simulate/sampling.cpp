#include "offline/simulate/sampling.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <stdexcept>
#include <utility>
#include <vector>

#include "offline/simulate/projection.hpp"
#include "offline/simulate/state_file.hpp"

namespace greenloop::offline {
namespace {

constexpr int coordinates = 24;
constexpr int states_per_orbit = 4;  // the last one, and others at random times

/// Random numbers of an orbit, whatever came before.
class Random {
 public:
  Random(std::uint64_t seed, std::uint64_t orbit) : generator_(seed * 0x9E3779B97F4A7C15ULL + orbit) {}

  /// 0..1, 1 excluded.
  double uniform() { return std::ldexp(static_cast<double>(generator_() >> 11), -53); }
  double between(double low, double high) { return low + (high - low) * uniform(); }
  template <class T>
  const T& one_of(const std::vector<T>& choices) {
    return choices[static_cast<std::size_t>(uniform() * static_cast<double>(choices.size()))];
  }

 private:
  std::mt19937_64 generator_;
};

/// A state in coordinates: displacement [m] and velocity [m/s].
struct Coordinates {
  Eigen::VectorXf q, v;
};

/// A state from which an orbit may start. Without `state` it is rest.
struct Start {
  std::optional<std::size_t> state;  // of the state file
  std::int64_t frame = -1;
  std::uint32_t row = 0;  // of the successions
  Coordinates at;
};

/// Where an orbit started.
struct Begun {
  std::size_t orbit = 0;
  Coordinates at;
};

std::uint64_t steps_of(double duration, double time_step) {
  return std::max<std::uint64_t>(1, static_cast<std::uint64_t>(std::lround(duration / time_step)));
}

class Sampler {
 public:
  Sampler(Simulator& simulator, const SamplingPlan& plan, TrajectoryWriter& file, const std::filesystem::path& states)
      : simulator_(simulator),
        plan_(plan),
        file_(file),
        states_(states, simulator.state().size(), frames_of(file.scene())),
        projection_(file.scene().rest, coordinates),
        positions_(file.scene().rest.size()) {
    const Eigen::VectorXf zero = Eigen::VectorXf::Zero(coordinates);
    rest_ = {std::nullopt, -1, impulses(), {zero, zero}};
    if (legal(rest_.row).empty()) throw std::invalid_argument("sampling: no impulse may come first");
  }

  void run(const Progress& progress) {
    const std::uint64_t all = std::uint64_t{plan_.held_out} + plan_.orbits;
    for (std::uint64_t next = file_.scene().orbits.size(); next < all && !reached(next); ++next) {
      if (progress) {
        progress(static_cast<double>(next) / static_cast<double>(all),
                 fmt::format("orbit {} of {}, {} frames{}", next + 1, all, frames_of(file_.scene()), estimate_text()));
      }
      Random random(plan_.seed, next);
      const bool held_out = next < plan_.held_out;
      const auto [start, impulse] =
          held_out || plan_.sampling == Sampling::random ? after_the_last(held_out, random) : farthest(random);
      play(start, impulse, held_out, random);
    }
  }

  /// The median replay error of held-out orbits; none: nothing is held out, or nothing else was played.
  std::optional<double> replay_error() {
    read_starts();
    std::vector<double> errors;
    for (const TrajectoryOrbit& orbit : file_.scene().orbits) {
      if (!orbit.held_out) continue;
      if (const auto error = replay_error_of(orbit)) errors.push_back(*error);
    }
    if (errors.empty()) return std::nullopt;
    const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
    std::nth_element(errors.begin(), middle, errors.end());
    return *middle;
  }

 private:
  /// Whether as many orbits replay as well as is asked for; looked at every few orbits.
  bool reached(std::uint64_t orbits) {
    constexpr std::uint64_t every = 5;
    const std::uint64_t played = orbits - std::min<std::uint64_t>(orbits, plan_.held_out);
    if (!(plan_.replay_goal > 0) || played == 0 || played % every != 0) return false;
    estimate_ = replay_error();
    return estimate_ && *estimate_ <= plan_.replay_goal;
  }

  [[nodiscard]] std::string estimate_text() const {
    return estimate_ ? fmt::format(", replay error {:.3g} %", 100 * *estimate_) : "";
  }

  /// Of the coordinates, as a model would replay it: in the orbit of the impulse whose start is nearest, as long as
  /// that goes on, while the difference of the starts dies out.
  [[nodiscard]] std::optional<double> replay_error_of(const TrajectoryOrbit& held_out) {
    const Coordinates start = start_of(held_out);
    const auto& others = starts_[held_out.impulse];
    const float rho_squared = balance();
    const auto nearest = std::min_element(others.begin(), others.end(), [&](const Begun& a, const Begun& b) {
      return squared_distance(a.at, start, rho_squared) < squared_distance(b.at, start, rho_squared);
    });
    if (nearest == others.end()) return std::nullopt;
    const TrajectoryOrbit& played = file_.scene().orbits[nearest->orbit];
    const double step = simulator_.time_step();
    const auto frames = std::min({held_out.frames, played.frames, steps_of(0.5, step) + 1});
    const double decay = std::exp(-std::min(3 / plan_.shortest, 0.2 / step) * step);
    Eigen::VectorXf offset = start.q - nearest->at.q;
    double difference = 0, size = 0;
    for (std::uint64_t k = 1; k < frames; ++k) {
      offset *= static_cast<float>(decay);
      const Eigen::VectorXf truth = projected(held_out.first_frame + k);
      difference += (truth - projected(played.first_frame + k) - offset).squaredNorm();
      size += truth.squaredNorm();
    }
    return size > 0 ? std::sqrt(difference / size) : 0;
  }

  static std::uint64_t frames_of(const TrajectoryScene& scene) {
    return scene.orbits.empty() ? 0 : scene.orbits.back().first_frame + scene.orbits.back().frames;
  }
  [[nodiscard]] std::uint32_t impulses() const { return static_cast<std::uint32_t>(file_.scene().impulses.size()); }

  [[nodiscard]] std::vector<std::uint32_t> legal(std::uint32_t row) const {
    std::vector<std::uint32_t> result;
    for (std::uint32_t i = 0; i < impulses(); ++i) {
      if (file_.scene().successions[row * impulses() + i] != 0) result.push_back(i);
    }
    return result;
  }

  /// A frame's displacement in coordinates.
  const Eigen::VectorXf& projected(std::uint64_t frame) {
    while (projected_.size() <= frame) {
      file_.read_frames(projected_.size(), 1, positions_);
      projected_.push_back(projection_.of(positions_));
    }
    return projected_[frame];
  }

  /// Of a frame and the one before it; of one that was at rest before if there is none.
  [[nodiscard]] Coordinates coordinates_of(std::uint64_t frame, std::int64_t before) {
    Coordinates at{projected(frame), Eigen::VectorXf::Zero(coordinates)};
    if (before < 0) return at;
    at.v = (at.q - projected(static_cast<std::uint64_t>(before))) / static_cast<float>(simulator_.time_step());
    return at;
  }

  [[nodiscard]] Coordinates start_of(const TrajectoryOrbit& orbit) {
    return orbit.previous_frame < 0 ? rest_.at : coordinates_of(orbit.first_frame, orbit.previous_frame);
  }

  /// Adds states and starts of what was played for the model since the last call; rest comes first.
  void read_starts() {
    if (candidates_.empty()) candidates_.push_back(rest_);
    for (; states_read_ < states_.frames().size(); ++states_read_) {
      const std::uint64_t frame = states_.frames()[states_read_];
      const auto& orbits = file_.scene().orbits;
      const auto behind = std::upper_bound(orbits.begin(), orbits.end(), frame,
                                           [](std::uint64_t f, const auto& orbit) { return f < orbit.first_frame; });
      const TrajectoryOrbit& orbit = *std::prev(behind);
      if (orbit.held_out) continue;
      const auto at = static_cast<std::int64_t>(frame);
      candidates_.push_back({states_read_, at, orbit.impulse, coordinates_of(frame, at - 1)});
    }
    starts_.resize(impulses());
    for (; orbits_read_ < file_.scene().orbits.size(); ++orbits_read_) {
      const TrajectoryOrbit& orbit = file_.scene().orbits[orbits_read_];
      if (orbit.held_out) continue;
      starts_[orbit.impulse].push_back({orbits_read_, start_of(orbit)});
    }
  }

  /// What a velocity counts beside a displacement, squared: rho^2.
  [[nodiscard]] float balance() const {
    float q = 0, v = 0;
    for (const Start& start : candidates_) {
      q = std::max(q, start.at.q.squaredNorm());
      v = std::max(v, start.at.v.squaredNorm());
    }
    return v > 0 ? q / v : 0;
  }

  static float squared_distance(const Coordinates& a, const Coordinates& b, float rho_squared) {
    return (a.q - b.q).squaredNorm() + rho_squared * (a.v - b.v).squaredNorm();
  }

  [[nodiscard]] float distance_to_starts(const Start& from, std::uint32_t impulse, float rho_squared) const {
    float nearest = std::numeric_limits<float>::infinity();
    for (const Begun& start : starts_[impulse]) {
      nearest = std::min(nearest, squared_distance(from.at, start.at, rho_squared));
    }
    return nearest;
  }

  std::pair<Start, std::uint32_t> farthest(Random& random) {
    read_starts();
    const float rho_squared = balance();
    std::pair<Start, std::uint32_t> best{rest_, random.one_of(legal(rest_.row))};
    float most = -1;
    for (const Start& candidate : candidates_) {
      for (const std::uint32_t impulse : legal(candidate.row)) {
        const float distance = distance_to_starts(candidate, impulse, rho_squared);
        if (distance > most) {
          most = distance;
          best = {candidate, impulse};
        }
      }
    }
    return best;
  }

  std::pair<Start, std::uint32_t> after_the_last(bool held_out, Random& random) {
    const auto& orbits = file_.scene().orbits;
    const bool goes_on = !orbits.empty() && orbits.back().held_out == held_out && !orbits.back().at_rest;
    const auto choices = goes_on ? legal(orbits.back().impulse) : std::vector<std::uint32_t>();
    if (choices.empty()) return {rest_, random.one_of(legal(rest_.row))};
    const Start last{
        states_.frames().size() - 1, static_cast<std::int64_t>(states_.frames().back()), orbits.back().impulse, {}};
    return {last, random.one_of(choices)};
  }

  [[nodiscard]] std::vector<std::uint64_t> kept_steps(std::uint64_t steps, Random& random) const {
    const auto first = steps_of(plan_.shortest, simulator_.time_step());
    std::vector<std::uint64_t> kept;
    for (int i = 1; i < states_per_orbit; ++i) {
      kept.push_back(
          static_cast<std::uint64_t>(random.between(static_cast<double>(first), static_cast<double>(steps))));
    }
    return kept;
  }

  [[nodiscard]] double longest_of(std::uint32_t impulse) const {
    const auto& limits = plan_.longest_of;
    return impulse < limits.size() ? limits[impulse].value_or(plan_.longest_to_rest) : plan_.longest_to_rest;
  }

  std::uint64_t add_frame() {
    simulator_.positions(positions_);
    return file_.add_frame(positions_);
  }

  void play(const Start& start, std::uint32_t impulse, bool held_out, Random& random) {
    const double to_rest = random.uniform(), duration = random.between(plan_.shortest, plan_.longest);
    const bool until_rest = to_rest < plan_.to_rest;
    const double limit = longest_of(impulse);
    const auto steps = steps_of(std::min(limit, until_rest ? plan_.longest_to_rest : duration), simulator_.time_step());
    const auto kept = kept_steps(std::min(steps, steps_of(plan_.longest, simulator_.time_step())), random);
    if (start.state) {
      simulator_.restore(states_.read(*start.state));
    } else {
      simulator_.reset();
    }
    file_.begin_orbit(impulse, start.state ? start.frame - 1 : -1, held_out);
    add_frame();
    simulator_.apply(impulse);
    bool at_rest = false;
    for (std::uint64_t step = 1; step <= steps && !at_rest; ++step) {
      simulator_.step();
      at_rest = simulator_.at_rest();
      const std::uint64_t frame = add_frame();
      const bool last = step == steps || at_rest;
      const bool keep = std::find(kept.begin(), kept.end(), step) != kept.end();
      if (last || keep) states_.append(frame, simulator_.state());
    }
    file_.end_orbit(at_rest);
  }

  Simulator& simulator_;
  const SamplingPlan& plan_;
  TrajectoryWriter& file_;
  StateFile states_;
  Projection projection_;
  std::vector<float> positions_;
  Start rest_;
  std::vector<Start> candidates_;
  std::vector<std::vector<Begun>> starts_;  // of each impulse
  std::vector<Eigen::VectorXf> projected_;  // all frames that were asked for, and those before
  std::optional<double> estimate_;
  std::size_t states_read_ = 0, orbits_read_ = 0;
};

void require_valid(const SamplingPlan& plan) {
  const bool valid = plan.shortest > 0 && plan.longest >= plan.shortest && plan.to_rest >= 0 && plan.to_rest <= 1 &&
                     plan.longest_to_rest >= plan.longest && plan.replay_goal >= 0 &&
                     (plan.replay_goal == 0 || plan.held_out > 0);
  if (!valid) {
    throw std::invalid_argument(
        "sampling: durations must be 0 < shortest <= longest <= longest to rest, the share to rest 0 to 1; a goal of "
        "replay needs orbits that are held out");
  }
}

}  // namespace

TrajectoryRoom room_for(const SamplingPlan& plan, double time_step) {
  require_valid(plan);
  const std::uint64_t orbits = std::uint64_t{plan.orbits} + plan.held_out;
  return {orbits * (1 + steps_of(plan.to_rest > 0 ? plan.longest_to_rest : plan.longest, time_step)), orbits};
}

TrajectoryScene describe(Simulator& simulator, std::vector<Impulse> impulses, std::vector<std::uint8_t> successions,
                         std::string provenance) {
  TrajectoryScene scene;
  scene.time_step = simulator.time_step();
  scene.rest.resize(3 * simulator.vertices());
  simulator.reset();
  simulator.positions(scene.rest);
  scene.triangles = simulator.triangles();
  scene.impulses = std::move(impulses);
  scene.successions = std::move(successions);
  scene.provenance = std::move(provenance);
  return scene;
}

std::optional<double> sample(Simulator& simulator, const SamplingPlan& plan, TrajectoryWriter& file,
                             const std::filesystem::path& states, const Progress& progress) {
  require_valid(plan);
  Sampler sampler(simulator, plan, file, states);
  sampler.run(progress);
  return sampler.replay_error();
}

}  // namespace greenloop::offline
