#pragma once

#include <cstdint>
#include <span>

#include "runtime/contact/candidate.hpp"
#include "runtime/contact/pose.hpp"
#include "runtime/memory/arena.hpp"
#include "runtime/vec.hpp"

namespace greenloop {

/// What a candidate keeps from one step to the next.
struct Grip {
  std::uint64_t key = 0;  ///< grip_key of its candidate
  bool touches = false;
  Double3 anchor;  ///< m, where it touches the tool, in the tool's frame
  Vec3 force;      ///< N, on the body
  bool sticks = false;
  bool stays = false;  ///< of the present step again, the same point of the body
  Double3 shift;       ///< m, of the body's point by all that acts
  Vec4 by_loads;       ///< m, the part of it that is there without contact forces
  // of the body's point
  std::uint32_t node[3] = {layout::none, layout::none, layout::none};
  double weight[3] = {};

  [[nodiscard]] bool is_at(const Candidate& candidate) const noexcept {
    bool same = true;
    for (int k = 0; k < 3; ++k) same = same && node[k] == candidate.node[k] && weight[k] == candidate.weight[k];
    return same;
  }
};

/// Which contact a candidate is: increasing in the order of CandidateSearch::find.
constexpr std::uint64_t grip_key(const Candidate& candidate) {
  const bool is_node = candidate.triangle == layout::none;
  return std::uint64_t{candidate.tool} << 33 |
         (is_node ? candidate.node[0] : std::uint64_t{1} << 32 | candidate.feature);
}

/// The tool that it is of.
constexpr std::uint64_t tool_of_key(std::uint64_t key) { return key >> 33; }

/// The candidates of the last answer, in the order of their keys.
class Grips {
 public:
  /// Room for so many; null while `arena` counts.
  void carve(Arena& arena, std::uint32_t contacts) noexcept;

  /// None stays in the present step so far. Linear.
  void begin_step() noexcept;

  /// The grip of a candidate, or null; asked in the order of their keys since `begin`. For the loop; work: linear in
  /// both over a step.
  void begin() noexcept { next_ = 0; }
  [[nodiscard]] Grip* find(std::uint64_t key) noexcept;

  /// Takes the next step's in, in the order of their keys, then puts them in the place of the last one's.
  void add(const Grip& grip) noexcept { made_[made_count_++] = grip; }
  void turn() noexcept;

  /// Takes over what a tool holds on to, without force, while there are no more than `room` in all; among `add`, by
  /// tool. shift_of(grip): m, the displacement of its point now. For the loop; linear in the grips.
  template <class ShiftOf>
  void keep(std::uint32_t tool, std::uint32_t room, ShiftOf shift_of) noexcept {
    for (std::uint32_t i = 0; i < count_ && made_count_ < room; ++i) {
      if (tool_of_key(grip_[i].key) != tool) continue;
      Grip kept = grip_[i];
      kept.force = {};
      kept.shift = shift_of(kept);
      add(kept);
    }
  }

  /// Lets go of what a tool has. Linear.
  void forget(std::uint32_t tool) noexcept;

  [[nodiscard]] std::span<const Grip> all() const noexcept { return {grip_, count_}; }

 private:
  Grip* grip_ = nullptr;  ///< [contacts]
  Grip* made_ = nullptr;  ///< [contacts]
  std::uint32_t count_ = 0, made_count_ = 0, next_ = 0;
};

}  // namespace greenloop
