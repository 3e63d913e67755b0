#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "rt_tests/harness/impulse_run.hpp"

namespace greenloop {

/// What impulses do to motions, by the seed alone.
enum class ImpulseScriptKind : std::uint8_t {
  mixed,    ///< ImpulseScript: impulses now and then, wrong ones, wrong buffers, budgets from refused to plenty
  play,     ///< an impulse of the palette or beyond it, legal or not, in every fiftieth step; states alone
  storm,    ///< one that may follow in every step: switches in the midst of blends
  garbage,  ///< impulses that may not follow or are none, vertices that there are not, buffers of other sizes
  starve,   ///< all vertices with velocities, by budgets from 0 to unlimited, those at thresholds among them
  frames,   ///< the same by all modes
  paces     ///< as `storm` and `play`, on bodies of rates, stretches and blend rates from one end to the other
};
inline constexpr std::array<const char*, 7> impulse_script_names = {"mixed",  "play",   "storm", "garbage",
                                                                    "starve", "frames", "paces"};

[[nodiscard]] constexpr const char* name(ImpulseScriptKind kind) {
  return impulse_script_names[static_cast<std::size_t>(kind)];
}

/// The cycles of a kind.
class ImpulseStressScript {
 public:
  ImpulseStressScript(const Model& model, const ImpulseResponse::Requirement& need, ImpulseScriptKind kind,
                      std::uint64_t seed);

  /// body: whose next step it is for.
  [[nodiscard]] ImpulseScript::Cycle next(const ImpulseResponse& body);

  /// Limits of which nothing is beyond what `create` takes; often at an end.
  [[nodiscard]] ImpulseResponse::Limits limits();

  /// For bodies of other limits.
  void declare(const ImpulseResponse::Requirement& need) { need_ = need; }

 private:
  [[nodiscard]] std::uint32_t below(std::uint32_t bound);
  [[nodiscard]] double between(double least, double most);  ///< evenly in the logarithm, both ends often
  [[nodiscard]] std::uint32_t legal_impulse(const ImpulseResponse& body);
  void spoil(const ImpulseResponse& body, ImpulseScript::Cycle& cycle);
  [[nodiscard]] std::uint64_t starved();

  ImpulseScript mixed_;
  ImpulseScriptKind kind_;
  bool lit_;  // the model has an appearance
  std::uint32_t impulses_, vertices_, modes_;
  double time_step_, rate_;
  ImpulseResponse::Requirement need_;
  std::uint64_t state_;
};

}  // namespace greenloop
