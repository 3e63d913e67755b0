#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "runtime/elastostatic.hpp"

namespace greenloop {

/// One cycle of a script.
struct ScriptedStep {
  std::vector<Contact> contacts;
  std::uint64_t budget = 0;
  bool with_field = true;
  bool valid = true;    ///< must be answered if the budget is at least Requirement::least_work
  bool smooth = false;  ///< the same patch as in the cycle before, pressed a little further
};

/// Random and adversarial contacts on a model: patches pressed and slid, all contacts at once, alternating sets, a new
/// set every cycle, released bodies, numbers of every size, and every kind of garbage; with budgets from none to any.
/// The same seed gives the same script.
class ContactScript {
 public:
  ContactScript(const ModelView& view, const Limits& limits, const Requirement& requirement, std::uint64_t seed);

  /// The next cycle; valid until the one after. Not for an armed section: it allocates.
  const ScriptedStep& next();

 private:
  enum class Kind : std::uint32_t { press, slide, scattered, alternate, thrash, release, extremes, garbage, count };

  void begin_burst();
  void place_patch();
  void touch(std::size_t first, std::size_t count);
  void scatter(std::size_t count);
  void spoil();
  void draw_budget();
  std::size_t below(std::size_t bound) { return static_cast<std::size_t>(random_() % bound); }
  float uniform() { return static_cast<float>(random_() >> 40) * 0x1p-23F - 1; }

  const ModelView* view_;
  std::uint32_t max_contacts_;
  Requirement requirement_;
  std::uint64_t worst_work_ = 0;
  std::vector<std::uint32_t> touchable_;
  std::vector<std::uint32_t> nearest_;  ///< touchable nodes by distance from the burst's centre
  std::mt19937_64 random_;
  Kind kind_ = Kind::press;
  std::uint32_t remaining_ = 0;
  std::uint32_t age_ = 0;
  float direction_[3] = {};
  ScriptedStep step_;
};

}  // namespace greenloop
