#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "runtime/elastostatic.hpp"

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
  static constexpr Elastostatic::Limits limits{.max_contacts = most_contacts, .cached_factors = 4};

  struct Cycle {
    std::span<const Constraint> contacts;  ///< valid until the next cycle; at most most_contacts + 1
    Budget budget;
    bool with_field;
  };

  /// `model` must outlive the script and have 1..most_touchable touchable nodes (`usable`).
  RecordedScript(const Model& model, const Elastostatic::Requirement& requirement) noexcept;

  [[nodiscard]] bool usable() const noexcept { return touchable_ > 0 && touchable_ <= most_touchable; }

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
  Elastostatic::Requirement requirement_;
  std::uint64_t state_ = 20;
  std::uint32_t touchable_ = 0;
  std::uint32_t not_touchable_ = 0;                    ///< a node that is not, if there is one
  std::array<Candidate, most_touchable> candidate_{};  ///< touchable nodes, in a burst by distance from its centre
  std::array<Constraint, most_contacts + 1> contact_{};
  std::uint32_t count_ = 0;
  Kind kind_ = Kind::press;
  std::uint32_t remaining_ = 0;
  std::uint32_t age_ = 0;
};

/// What came of a whole script.
struct ScriptOutcome {
  std::uint64_t digest = 0;  ///< of every report, force and field
  std::array<std::uint32_t, 10> by_status{};
  std::uint32_t cached = 0;   ///< answers from a cached factor
  std::uint32_t levels = 0;   ///< bit c: some contacts were resolved at level c
  std::uint32_t refined = 0;  ///< answers at a finer level than the last, whose factor was made in slices
  std::uint64_t work = 0;     ///< units in all

  /// Whether the script met all it is meant to meet on a model of that many levels.
  [[nodiscard]] bool complete(std::uint32_t model_levels) const noexcept;
};

/// The digests of the script on write_recorded_model's models: what every target has to find.
inline constexpr std::uint64_t recorded_digest = 0xedd51eb3146ab249;  ///< lifted Linear wavelets
inline constexpr std::uint64_t recorded_lifted_butterfly_digest = 0xa398c99615c64c55;
inline constexpr std::uint64_t recorded_butterfly_digest = 0xa0339b07d556c417;
inline constexpr std::uint64_t recorded_equilibrated_digest = 0x6ff40a022aafac57;

/// A body that ran the whole script, or why it did not.
struct RecordedRun {
  const char* error = nullptr;  ///< null: it ran
  std::size_t arena_bytes = 0;
  ScriptOutcome outcome;
};

/// Runs the script on the model file in `bytes`. field: 16-byte aligned, at least 4 floats per node. With `flip` one
/// bit of one answer is changed, a negative control.
[[nodiscard]] RecordedRun run_recorded_script(std::span<const std::byte> bytes, std::span<std::byte> arena,
                                              std::span<float> field, bool flip) noexcept;

}  // namespace greenloop
