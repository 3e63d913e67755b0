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
    for (std::uint64_t next = file_.scene().orbits.size(); next < all; ++next) {
      if (progress) {
        progress(static_cast<double>(next) / static_cast<double>(all),
                 fmt::format("orbit {} of {}, {} frames", next + 1, all, frames_of(file_.scene())));
      }
      Random random(plan_.seed, next);
      const bool held_out = next < plan_.held_out;
      const auto [start, impulse] =
          held_out || plan_.sampling == Sampling::random ? after_the_last(held_out, random) : farthest(random);
      play(start, impulse, held_out, random);
    }
  }

 private:
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

  /// Of a frame and the one before it; of one that was at rest before if there is none.
  [[nodiscard]] Coordinates coordinates_of(std::uint64_t frame, std::int64_t before) {
    file_.read_frames(frame, 1, positions_);
    Coordinates at{projection_.of(positions_), Eigen::VectorXf::Zero(coordinates)};
    if (before < 0) return at;
    file_.read_frames(static_cast<std::uint64_t>(before), 1, positions_);
    at.v = (at.q - projection_.of(positions_)) / static_cast<float>(simulator_.time_step());
    return at;
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
      starts_[orbit.impulse].push_back(
          orbit.previous_frame < 0 ? rest_.at : coordinates_of(orbit.first_frame, orbit.previous_frame));
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

  [[nodiscard]] float distance_to_starts(const Start& from, std::uint32_t impulse, float rho_squared) const {
    float nearest = std::numeric_limits<float>::infinity();
    for (const Coordinates& start : starts_[impulse]) {
      nearest =
          std::min(nearest, (from.at.q - start.q).squaredNorm() + rho_squared * (from.at.v - start.v).squaredNorm());
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

  std::uint64_t add_frame() {
    simulator_.positions(positions_);
    return file_.add_frame(positions_);
  }

  void play(const Start& start, std::uint32_t impulse, bool held_out, Random& random) {
    const double to_rest = random.uniform(), duration = random.between(plan_.shortest, plan_.longest);
    const bool until_rest = to_rest < plan_.to_rest;
    const auto steps = steps_of(until_rest ? plan_.longest_to_rest : duration, simulator_.time_step());
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
  std::vector<std::vector<Coordinates>> starts_;  // of each impulse
  std::size_t states_read_ = 0, orbits_read_ = 0;
};

void require_valid(const SamplingPlan& plan) {
  const bool valid = plan.shortest > 0 && plan.longest >= plan.shortest && plan.to_rest >= 0 && plan.to_rest <= 1 &&
                     plan.longest_to_rest >= plan.longest;
  if (!valid) {
    throw std::invalid_argument(
        "sampling: durations must be 0 < shortest <= longest <= longest to rest, the share to rest 0 to 1");
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

void sample(Simulator& simulator, const SamplingPlan& plan, TrajectoryWriter& file, const std::filesystem::path& states,
            const Progress& progress) {
  require_valid(plan);
  Sampler(simulator, plan, file, states).run(progress);
}

}  // namespace greenloop::offline
