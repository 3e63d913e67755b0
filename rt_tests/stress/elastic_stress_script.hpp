#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "runtime/multigrid.hpp"

namespace greenloop {

/// What acts on a body of a multigrid model, by the seed alone.
enum class ElasticScriptKind : std::uint8_t {
  mixed,    ///< loads, a vertex that is led, gravity and answers that change now and then, budgets from short to plenty
  loads,    ///< as many loads as there may be, others in every step
  holds,    ///< vertices that are taken hold of, led, let go
  garbage,  ///< in every other step: numbers that are none, vertices that there are not or twice, wrong buffers
  huge,     ///< now and then loads, gravity or holds up to the largest number
  starve    ///< budgets from 0 to unlimited, those at thresholds among them
};
inline constexpr std::array<const char*, 6> elastic_script_names = {"mixed",   "loads", "holds",
                                                                    "garbage", "huge",  "starve"};

[[nodiscard]] constexpr const char* name(ElasticScriptKind kind) {
  return elastic_script_names[static_cast<std::size_t>(kind)];
}

/// The inputs of a step, and what it is asked for.
struct ElasticCycle {
  std::vector<Multigrid::Load> loads;
  std::vector<Multigrid::Hold> holds;
  Vec3 gravity{};
  bool turned = false;  ///< gravity in place of the model's
  Budget budget;
  bool shown = false, stress = false;
  std::vector<std::uint32_t> chosen;
  std::size_t surplus = 0;  ///< displacements that the buffer has beyond what is right: to be refused
};

/// The cycles of a kind.
class ElasticStressScript {
 public:
  ElasticStressScript(const MultigridView& view, const Multigrid::Limits& limits, const Multigrid::Requirement& need,
                      ElasticScriptKind kind, std::uint64_t seed);

  /// displacement: of all vertices, where the body is.
  [[nodiscard]] const ElasticCycle& next(std::span<const Vec3> displacement);

 private:
  [[nodiscard]] std::uint32_t below(std::uint32_t bound);
  [[nodiscard]] float between(float low, float high);
  [[nodiscard]] Vec3 vector(float size);
  void load(std::uint32_t count);
  void take_hold(std::span<const Vec3> displacement);
  void lead();
  void ask();
  void spoil();
  void exaggerate();
  [[nodiscard]] std::uint64_t enough() const;
  [[nodiscard]] std::uint64_t starved();

  ElasticScriptKind kind_;
  std::uint32_t vertices_, free_, most_loads_, most_holds_;
  Multigrid::Requirement need_;
  float force_ = 0, travel_ = 0;  // N of a load, m a cycle of a hold, at most
  std::vector<Vec3> velocity_;    // m a cycle, of each hold
  ElasticCycle acting_, given_;   // what goes on, and what this step has
  std::uint64_t state_;
};

}  // namespace greenloop
