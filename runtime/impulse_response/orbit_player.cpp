#include "runtime/impulse_response/orbit_player.hpp"

#include <cmath>

namespace greenloop {
namespace {

using layout::none;
using layout::OrbitRecord;

constexpr float unit = 1.0F / layout::most_coordinate;
constexpr float phase_unit = 0x1p-32F;
constexpr float vanished = 1e-20F;  // of a difference, in amplitudes: what is smaller becomes zero, no denormal number

float decayed(float difference, float decay) {
  const float left = difference * decay;
  return left < vanished && left > -vanished ? 0 : left;
}

}  // namespace

void OrbitPlayer::carve(Arena& arena, const ImpulseResponseView& view) noexcept {
  view_ = &view;
  position_ = arena.take_zeroed<float>(view.modes);
  velocity_ = arena.take_zeroed<float>(view.modes);
  position_offset_ = arena.take_zeroed<float>(view.modes);
  velocity_offset_ = arena.take_zeroed<float>(view.modes);
  transfer_ = arena.take_zeroed<float>(view.appearance.modes);
  transfer_offset_ = arena.take_zeroed<float>(view.appearance.modes);
}

void OrbitPlayer::begin(std::uint64_t ticks, float decay, float seconds) noexcept {
  place_ = {};
  ticks_ = ticks;
  decay_ = decay;
  per_second_ = 1 / seconds;
  evaluate();
}

// visit(mode, its coordinates in the rows before, at and behind the place), of the orbit alone; coordinates: of all
// rows
template <class Visit>
void OrbitPlayer::visit_rows(const std::int16_t* coordinates, std::uint32_t modes, Visit visit) const noexcept {
  const std::uint32_t row = place_.row;
  const std::uint32_t behind = row + 1 < orbit().first_row + orbit().rows ? row + 1 : row;
  const std::int16_t* const before = coordinates + std::size_t{modes} * (row - 1);
  const std::int16_t* const at = coordinates + std::size_t{modes} * row;
  const std::int16_t* const after = coordinates + std::size_t{modes} * behind;
  for (std::uint32_t m = 0; m < modes; ++m) {
    visit(m, static_cast<float>(before[m]), static_cast<float>(at[m]), static_cast<float>(after[m]));
  }
}

template <class Visit>
void OrbitPlayer::visit_modes(Visit visit) const noexcept {
  std::uint32_t first = 0;
  for (std::uint32_t q = 0; q < view_->levels; ++q) {
    const std::uint32_t modes = view_->group[q].counts->modes;
    visit_rows(view_->group[q].coordinates, modes,
               [&](std::uint32_t m, float before, float at, float after) { visit(first + m, before, at, after); });
    first += modes;
  }
}

template <class Visit>
void OrbitPlayer::visit_transfers(Visit visit) const noexcept {
  visit_rows(view_->appearance.coordinates, view_->appearance.modes, visit);
}

void OrbitPlayer::evaluate() noexcept {
  const float phase = static_cast<float>(place_.phase) * phase_unit;
  const float speed = at_rest() ? 0.0F : unit * per_second_;  // what has come to rest stands still
  const float speed_after = rests_at(place_.row + 1) ? 0.0F : unit * per_second_;
  visit_modes([&](std::uint32_t m, float before, float at, float after) {
    const float step = after - at;
    const float velocity = (at - before) * speed;
    position_[m] = (at + phase * step) * unit + position_offset_[m];
    velocity_[m] = velocity + phase * (step * speed_after - velocity) + velocity_offset_[m];
  });
  visit_transfers([&](std::uint32_t m, float, float at, float after) {
    transfer_[m] = (at + phase * (after - at)) * unit + transfer_offset_[m];
  });
}

// Differences become those from the state `to`, at the same phase, of the place as it is.
void OrbitPlayer::go_over(const OrbitPlace& to) noexcept {
  const float speed = unit * per_second_;
  visit_modes([&](std::uint32_t m, float before, float at, float) {
    position_offset_[m] += at * unit;
    velocity_offset_[m] += (at - before) * speed;
  });
  visit_transfers([&](std::uint32_t m, float, float at, float) { transfer_offset_[m] += at * unit; });
  place_ = to;
  visit_modes([&](std::uint32_t m, float before, float at, float) {
    position_offset_[m] -= at * unit;
    velocity_offset_[m] -= (at - before) * speed;
  });
  visit_transfers([&](std::uint32_t m, float, float at, float) { transfer_offset_[m] -= at * unit; });
}

void OrbitPlayer::enter(std::uint32_t orbit) noexcept {
  place_ = {orbit, view_->orbits[orbit].first_row + 1, 0};
  visit_modes([&](std::uint32_t m, float before, float at, float) {
    position_offset_[m] = position_[m] - at * unit;
    velocity_offset_[m] = velocity_[m] - (at - before) * (unit * per_second_);
  });
  visit_transfers([&](std::uint32_t m, float, float at, float) { transfer_offset_[m] = transfer_[m] - at * unit; });
}

Continuations OrbitPlayer::pass() noexcept {
  for (std::uint32_t m = 0; m < view_->modes; ++m) {
    position_offset_[m] = decayed(position_offset_[m], decay_);
    velocity_offset_[m] = decayed(velocity_offset_[m], decay_);
  }
  for (std::uint32_t m = 0; m < view_->appearance.modes; ++m)
    transfer_offset_[m] = decayed(transfer_offset_[m], decay_);
  Continuations made;
  const std::uint64_t ticks = place_.phase + ticks_;
  place_.phase = static_cast<std::uint32_t>(ticks);
  auto left = static_cast<std::uint32_t>(ticks >> 32U);
  while (left > 0 && !at_rest()) {
    const OrbitRecord& played = orbit();
    const std::uint32_t last = played.first_row + played.rows - 1;
    const std::uint32_t passed = last - place_.row < left ? last - place_.row : left;
    place_.row += passed;
    left -= passed;
    if (place_.row == last && played.next_orbit != none) {
      made = {made.count + 1, played.next_distance};
      go_over({played.next_orbit, played.next_row, place_.phase});
    }
  }
  if (at_rest()) place_.phase = 0;
  evaluate();
  return made;
}

std::uint32_t most_continuations(const ImpulseResponseView& view, std::uint64_t ticks) noexcept {
  std::uint32_t shortest = 0;  // rows from where an orbit is continued in to its end
  for (const OrbitRecord& from : view.orbits) {
    if (from.next_orbit == none) continue;
    const OrbitRecord& next = view.orbits[from.next_orbit];
    const std::uint32_t rows = next.first_row + next.rows - 1 - from.next_row;
    shortest = shortest == 0 || rows < shortest ? rows : shortest;
  }
  const auto passed = static_cast<std::uint32_t>(ticks >> 32U) + 1;
  return shortest == 0 ? 0 : 1 + passed / shortest;
}

float OrbitPlayer::blend() const noexcept {
  float sum = 0;
  std::uint32_t mode = 0;
  for (std::uint32_t q = 0; q < view_->levels; ++q) {
    for (std::uint32_t m = 0; m < view_->group[q].counts->modes; ++m, ++mode) {
      const float difference = view_->group[q].amplitudes[m].amplitude * position_offset_[mode];
      sum += difference * difference;
    }
  }
  return std::sqrt(sum);
}

}  // namespace greenloop
