#pragma once

#include <cstdint>

#include "formats/view/impulse_response.hpp"
#include "runtime/memory/arena.hpp"

namespace greenloop {

/// Where the time of a loop is among the states of a model: in row `row` of an orbit, `phase` / 2^32 of a time step
/// behind it.
struct OrbitPlace {
  std::uint32_t orbit = 0;
  std::uint32_t row = 1;
  std::uint32_t phase = 0;
};

/// What a step passed at ends of orbits.
struct Continuations {
  std::uint32_t count = 0;
  float distance = 0;  ///< m, of the states between which the last one led
};

/// Continuations that a step of so many ticks (OrbitPlayer::begin) may need. Start-up; work: linear in the orbits.
[[nodiscard]] std::uint32_t most_continuations(const ImpulseResponseView& view, std::uint64_t ticks) noexcept;

/// Plays orbits and blends them, with their radiance transfer (James & Fatahalian 2003, section 5.2). Coordinates are
/// in units of their modes' amplitudes, velocities in those a second.
class OrbitPlayer {
 public:
  /// Most states that a step may pass.
  static constexpr std::uint32_t most_rows = 64;

  /// Takes its arrays from the arena. Start-up; work: linear in the modes.
  void carve(Arena& arena, const ImpulseResponseView& view) noexcept;

  /// Begins at rest. ticks: 2^-32 of the model's time steps that pass in a step, at most most_rows of these; decay:
  /// what is left of a difference after a step; seconds: of the model's time step. Start-up; work: linear in the modes.
  void begin(std::uint64_t ticks, float decay, float seconds) noexcept;

  /// The orbit that an impulse leads to from where the time is, and how far its start is away; orbit `none` if it may
  /// not follow. impulse: of the model. For the loop; work: constant.
  [[nodiscard]] layout::ReferenceRecord reference(std::uint32_t impulse) const noexcept {
    return view_->references[std::size_t{place_.row} * view_->info->impulses + impulse];
  }

  /// Goes over to the start of an orbit: what differs dies out. For the loop; work: linear in the modes.
  void enter(std::uint32_t orbit) noexcept;

  /// Lets a step pass: goes over to others at ends of orbits that have not come to rest. For the loop; work: linear in
  /// the modes times continuations, at most `most_continuations`.
  Continuations pass() noexcept;

  [[nodiscard]] const OrbitPlace& place() const noexcept { return place_; }
  [[nodiscard]] const layout::OrbitRecord& orbit() const noexcept { return view_->orbits[place_.orbit]; }
  [[nodiscard]] bool at_rest() const noexcept { return rests_at(place_.row); }
  /// m, the Euclidean norm of the displacement that blending still adds. For the loop; work: linear in the modes.
  [[nodiscard]] float blend() const noexcept;
  [[nodiscard]] const float* position() const noexcept { return position_; }  ///< [modes]
  [[nodiscard]] const float* velocity() const noexcept { return velocity_; }  ///< [modes]
  [[nodiscard]] const float* transfer() const noexcept { return transfer_; }  ///< [transfer modes] q_a

 private:
  [[nodiscard]] bool rests_at(std::uint32_t row) const noexcept {
    return orbit().next_orbit == layout::none && row == orbit().first_row + orbit().rows - 1;
  }
  template <class Visit>
  void visit_rows(const std::int16_t* coordinates, std::uint32_t modes, Visit visit) const noexcept;
  template <class Visit>
  void visit_modes(Visit visit) const noexcept;
  template <class Visit>
  void visit_transfers(Visit visit) const noexcept;
  void go_over(const OrbitPlace& to) noexcept;
  void evaluate() noexcept;

  const ImpulseResponseView* view_ = nullptr;
  OrbitPlace place_;
  std::uint64_t ticks_ = 0;
  float decay_ = 0;
  float per_second_ = 0;              // time steps of the model
  float* position_ = nullptr;         // [modes] now
  float* velocity_ = nullptr;         // [modes]
  float* position_offset_ = nullptr;  // [modes] what is left of differences
  float* velocity_offset_ = nullptr;  // [modes]
  float* transfer_ = nullptr;         // [transfer modes] now
  float* transfer_offset_ = nullptr;  // [transfer modes] what is left of differences
};

}  // namespace greenloop
