#include "formats/testing/synthetic_motion.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>

namespace greenloop {
namespace {

using layout::none;

// A damped oscillation for each mode, in steps.
struct State {
  std::vector<double> position, velocity;  // of each mode; a step is the unit of time
};

double frequency(std::uint32_t mode) { return 0.2 * std::sqrt(mode + 1.0); }

void advance(State& state) {
  constexpr double damping = 0.05;
  for (std::uint32_t m = 0; m < state.position.size(); ++m) {
    const double w = frequency(m);
    state.velocity[m] -= w * w * state.position[m] + damping * state.velocity[m];
    state.position[m] += state.velocity[m];
  }
}

// of the impulse on a mode, in units of its amplitude a step
double push(std::uint32_t impulse, std::uint32_t mode) {
  return (impulse % 2 == 0 ? 1.0 : -1.0) * frequency(mode) * 0.5 / (1 + mode + impulse);
}

class Motion {
 public:
  explicit Motion(const SyntheticMotion& options) : options_(options), random_(7) {
    State rest{std::vector<double>(options.modes), std::vector<double>(options.modes)};
    add_orbit(none, rest, rest, 2);
    for (std::uint32_t i = 0; i < options.orbits; ++i) add_pushed(i % options.impulses);
  }

  [[nodiscard]] std::vector<layout::OrbitRecord> orbits() const { return orbits_; }
  [[nodiscard]] std::uint32_t rows() const { return static_cast<std::uint32_t>(states_.size()); }
  [[nodiscard]] double at(std::uint32_t row, std::uint32_t mode) const { return states_[row].position[mode]; }
  [[nodiscard]] double distance(std::uint32_t a, std::uint32_t b) const {
    double sum = 0;
    for (std::uint32_t m = 0; m < options_.modes; ++m) {
      sum += std::pow(at(a, m) - at(b, m), 2) + std::pow(states_[a].velocity[m] - states_[b].velocity[m], 2);
    }
    return std::sqrt(sum);
  }

  // the last orbit of each impulse comes to rest; the others go on in the middle of it
  void continue_orbits() {
    for (std::uint32_t i = 1; i < orbits_.size(); ++i) {
      layout::OrbitRecord& orbit = orbits_[i];
      std::uint32_t last = i;
      for (std::uint32_t k = i; k < orbits_.size(); ++k) last = orbits_[k].impulse == orbit.impulse ? k : last;
      if (last == i) continue;
      orbit.next_orbit = last;
      orbit.next_row = orbits_[last].first_row + orbits_[last].rows / 2;
      orbit.next_distance = static_cast<float>(distance(orbit.first_row + orbit.rows - 1, orbit.next_row));
    }
  }

 private:
  void add_orbit(std::uint32_t impulse, const State& before, State state, std::uint32_t rows) {
    layout::OrbitRecord orbit{};
    orbit.first_row = this->rows();
    orbit.rows = rows;
    orbit.impulse = impulse;
    orbit.next_orbit = orbit.next_row = none;
    states_.push_back(before);
    states_.push_back(state);
    for (std::uint32_t m = 0; m < options_.modes && impulse != none; ++m) state.velocity[m] += push(impulse, m);
    for (std::uint32_t k = 2; k < rows; ++k) {
      advance(state);
      states_.push_back(state);
    }
    orbits_.push_back(orbit);
  }

  void add_pushed(std::uint32_t impulse) {
    const auto& from = orbits_[random_() % orbits_.size()];
    const std::uint32_t row = from.first_row + 1 + static_cast<std::uint32_t>(random_() % (from.rows - 1));
    const State before = states_[row - 1], start = states_[row];
    add_orbit(impulse, before, start, options_.rows);
  }

  SyntheticMotion options_;
  std::mt19937 random_;
  std::vector<State> states_;
  std::vector<layout::OrbitRecord> orbits_;
};

std::vector<layout::ReferenceRecord> references(const Motion& motion, const ImpulseResponseData& model) {
  const auto impulses = static_cast<std::uint32_t>(model.impulses.size());
  std::vector<layout::ReferenceRecord> all;
  for (const layout::OrbitRecord& from : model.orbits) {
    for (std::uint32_t row = from.first_row; row < from.first_row + from.rows; ++row) {
      for (std::uint32_t i = 0; i < impulses; ++i) {
        layout::ReferenceRecord nearest{none, 0};
        const std::uint32_t before = from.impulse == none ? impulses : from.impulse;
        for (std::uint32_t k = 1; k < model.orbits.size() && model.successions[before * impulses + i] != 0; ++k) {
          if (model.orbits[k].impulse != i) continue;
          const auto distance = static_cast<float>(motion.distance(row, model.orbits[k].first_row + 1));
          if (nearest.orbit == none || distance < nearest.distance) nearest = {k, distance};
        }
        all.push_back(nearest);
      }
    }
  }
  return all;
}

// what the modes look like: waves along the strip
double wave(std::uint32_t mode, std::uint32_t component, double along) {
  return std::sin(std::numbers::pi * (mode + 1) * along + component) / (1 + mode);
}

void add_strip(const SyntheticMotion& options, ImpulseResponseData& model) {
  for (std::uint32_t v = 0; v < options.vertices; ++v) {
    model.shape.insert(model.shape.end(), {0.01F * static_cast<float>(v / 2), 0.01F * static_cast<float>(v % 2), 0});
    if (v >= 2) model.triangles.insert(model.triangles.end(), {v - 2, v - 1, v});
  }
}

// mostly the even light's coefficient, and modes that follow those of displacement
AppearanceData appearance_of(const SyntheticMotion& options, const Motion& motion,
                             const std::vector<double>& amplitude) {
  AppearanceData appearance;
  appearance.states = motion.rows();
  appearance.error = 0.2F;
  const std::uint32_t blocks = (options.vertices + layout::block_vertices - 1) / layout::block_vertices;
  for (std::uint32_t block = 0; block < blocks; ++block) {
    appearance.quanta.insert(appearance.quanta.end(), {0.2F / 127 / 256, 0.02F / 127});
    for (std::uint32_t i = 0; i < layout::colours * layout::transfer_bytes(options.transfer_modes); ++i) {
      const auto of_colour = static_cast<std::uint32_t>(layout::transfer_bytes(options.transfer_modes));
      const std::uint32_t mode = i % of_colour / (layout::light_coefficients * layout::block_vertices);
      const double along = block + i % 32 / 2 / 16.0;
      const double value = wave(mode, i % 7, along / blocks) * (mode == 0 && i % 16 != 0 ? 0.2 : 1.0);
      appearance.transfers.push_back(static_cast<std::int8_t>(std::lround(127 * value)));
    }
  }
  for (std::uint32_t m = 0; m < options.transfer_modes; ++m) {
    appearance.amplitudes.push_back({1.0F / static_cast<float>(m + 1), 0.5F / static_cast<float>(m + 1)});
  }
  for (std::uint32_t row = 0; row < motion.rows(); ++row) {
    for (std::uint32_t m = 0; m < options.transfer_modes; ++m) {
      const double at = motion.at(row, m % options.modes) / amplitude[m % options.modes];
      appearance.coordinates.push_back(static_cast<std::int16_t>(std::lround(at * layout::most_coordinate)));
    }
  }
  return appearance;
}

}  // namespace

ImpulseResponseData synthetic_motion(const SyntheticMotion& options) {
  Motion motion(options);
  motion.continue_orbits();
  ImpulseResponseData model;
  layout::ImpulseInfo& info = model.info;
  info.planes = options.planes;
  info.time_step = options.time_step;
  info.rate = 1000;
  info.blend_rate = options.blend_rate;
  info.velocity_balance = options.time_step;
  info.displacement = 0.01F;
  info.source_rows = motion.rows();
  std::fill(std::begin(info.box_max), std::end(info.box_max), 1.0F);
  model.provenance = "{}";
  add_strip(options, model);

  for (std::uint32_t i = 0; i < options.impulses; ++i) {
    layout::ImpulseRecord impulse{};
    std::snprintf(impulse.name, sizeof(impulse.name), "push %u", i);
    impulse.initial[0] = i % 2 == 0 ? 1.0F : -1.0F;
    model.impulses.push_back(impulse);
  }
  for (std::uint32_t before = 0; before <= options.impulses; ++before) {
    for (std::uint32_t i = 0; i < options.impulses; ++i) {
      model.successions.push_back(options.alternating && before == i ? 0 : 1);
    }
  }
  model.orbits = motion.orbits();
  model.references = references(motion, model);

  std::vector<double> amplitude(options.modes);
  for (std::uint32_t row = 0; row < motion.rows(); ++row) {
    for (std::uint32_t m = 0; m < options.modes; ++m) {
      amplitude[m] = std::max(amplitude[m], std::abs(motion.at(row, m)));
    }
  }
  if (options.transfer_modes > 0) model.appearance = appearance_of(options, motion, amplitude);
  const std::int32_t most = layout::most_value(options.planes);
  constexpr double scale = 0.01;  // m
  const double quantum = scale / most;
  model.quanta.assign((options.vertices + layout::block_vertices - 1) / layout::block_vertices,
                      static_cast<float>(quantum));
  const std::uint32_t pairs = options.modes / 2;
  for (std::uint32_t q = 0; q < options.groups; ++q) {
    const std::uint32_t begin = 2 * (pairs * q / options.groups), end = 2 * (pairs * (q + 1) / options.groups);
    ModeGroupData group;
    group.counts.truncation_error = 0.1F / static_cast<float>(end);
    group.counts.worst_error = 2 * group.counts.truncation_error;
    for (std::uint32_t m = begin; m < end; ++m) {
      group.amplitudes.push_back({static_cast<float>(scale * amplitude[m]), 0.1F / static_cast<float>(m + 1)});
    }
    for (std::uint32_t v = 0; v < 3 * options.vertices; ++v) {
      const double along = static_cast<double>(v / 3) / options.vertices;
      for (std::uint32_t m = begin; m < end; ++m) {
        group.values.push_back(static_cast<std::int16_t>(std::lround(wave(m, v % 3, along) * most)));
      }
    }
    for (std::uint32_t row = 0; row < motion.rows(); ++row) {
      for (std::uint32_t m = begin; m < end; ++m) {
        const double at = motion.at(row, m) / amplitude[m];
        group.coordinates.push_back(static_cast<std::int16_t>(std::lround(at * layout::most_coordinate)));
      }
    }
    model.groups.push_back(std::move(group));
  }
  return model;
}

}  // namespace greenloop
