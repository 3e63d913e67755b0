#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "rt_tests/harness/script_bounds.hpp"
#include "runtime/constraint.hpp"
#include "runtime/loop.hpp"
#include "runtime/model.hpp"

namespace greenloop {

/// 10,000 cycles of contacts, the same on every target: made by integer arithmetic and comparisons alone, without heap.
/// Patches are pressed, slid and swapped for others, single nodes scattered, bodies released; displacements go from
/// denormal to beyond what can be answered; budgets from refused over those that force coarse levels to unlimited; and
/// every kind of garbage is mixed in.
class RecordedScript {
 public:
  static constexpr std::uint32_t cycles = 10'000;
  static constexpr std::uint32_t most_contacts = 8;
  static constexpr std::uint32_t most_touchable = 192;
  static constexpr std::uint32_t sets = 4;  ///< that the body is to remember

  struct Cycle {
    std::span<const Constraint> contacts;  ///< valid until the next cycle; at most most_contacts + 1
    Budget budget;
    bool with_field;
  };

  /// `model` must outlive the script and have touchable nodes (`usable`), of which the first most_touchable are
  /// touched.
  RecordedScript(const Model& model, const ScriptBounds& bounds, std::uint64_t seed = 20) noexcept;

  [[nodiscard]] bool usable() const noexcept { return touchable_ > 0; }

  /// The next cycle.
  [[nodiscard]] Cycle next() noexcept;

 private:
  enum class Kind : std::uint32_t { press, slide, alternate, scatter, release, extremes, garbage, count };

  struct Candidate {
    float square_distance;
    std::uint32_t node;
  };

  void begin_burst() noexcept;
  void sort_by_distance_from(std::uint32_t centre) noexcept;
  void touch(std::uint32_t first, std::uint32_t count, float depth) noexcept;
  void scatter(std::uint32_t count, float depth) noexcept;
  void spoil() noexcept;
  [[nodiscard]] float extreme_depth() noexcept;
  [[nodiscard]] Budget draw_budget() noexcept;
  [[nodiscard]] std::uint64_t random() noexcept;
  [[nodiscard]] std::uint32_t below(std::uint32_t bound) noexcept;
  [[nodiscard]] float uniform() noexcept;  ///< -1..1

  const Model* model_;
  ScriptBounds bounds_;
  std::uint64_t state_;
  std::uint32_t touchable_ = 0;
  std::uint32_t not_touchable_ = 0;                    ///< a node that is not, if there is one
  std::array<Candidate, most_touchable> candidate_{};  ///< touchable nodes, in a burst by distance from its centre
  std::array<Constraint, most_contacts + 1> contact_{};
  std::uint32_t count_ = 0;
  Kind kind_ = Kind::press;
  std::uint32_t remaining_ = 0;
  std::uint32_t age_ = 0;
};

}  // namespace greenloop
