#pragma once

#include <array>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include "formats/view.hpp"
#include "rt_tests/harness/dear_sets.hpp"
#include "rt_tests/harness/script_bounds.hpp"
#include "runtime/constraint.hpp"

namespace greenloop {

/// What a script does to a body, cycle by cycle.
enum class ScriptKind : std::uint8_t {
  single,        ///< one contact
  press,         ///< a patch, pressed ever further
  slide,         ///< a patch that moves on by a node each cycle
  every_node,    ///< every touchable node at once, as many as the limits allow
  neighbours,    ///< two patches beside each other in turn
  coincident,    ///< the two nodes of the shortest edges, held against each other
  random,        ///< a new set each cycle
  defeat_cache,  ///< one set more than there are cached factors, in turn
  flap_levels,   ///< contacts that stay for some cycles, budgets in turn the least and unlimited
  extremes,      ///< displacements from zero over denormal to far too large
  release,       ///< nothing is touched
  garbage,       ///< NaN, infinite, out of range, not touchable, twice, too many
  mixed,         ///< bursts of all of those in random order
  hunt           ///< the dearest sets that a hunt finds, at budgets that hold them and such that do not quite
};
inline constexpr std::array<const char*, 14> contact_script_names = {
    "single",       "press",       "slide",    "every-node", "neighbours", "coincident", "random",
    "defeat-cache", "flap-levels", "extremes", "release",    "garbage",    "mixed",      "hunt"};

constexpr const char* name(ScriptKind kind) { return contact_script_names[static_cast<std::size_t>(kind)]; }

/// One cycle of a script.
struct ScriptedStep {
  std::vector<Constraint> contacts;
  std::uint64_t budget = 0;
  bool with_field = true;
  bool valid = true;  ///< must be answered if the budget is at least Requirement::least_work
};

/// Random and adversarial contacts on a model, in bursts of one kind: with budgets from none to any in half of them,
/// unlimited in the others. The same kind and seed give the same script.
class ContactScript {
 public:
  /// `view` must outlive it. dear: what `hunt` goes over, needed by no other. Throws std::runtime_error if no node is
  /// touchable.
  ContactScript(const ModelView& view, const ScriptBounds& bounds, ScriptKind kind, std::uint64_t seed,
                std::vector<DearSet> dear = {});

  /// The next cycle; valid until the one after. Not for an armed section: it allocates.
  const ScriptedStep& next();

 private:
  using Pair = std::pair<std::uint32_t, std::uint32_t>;

  void list_touchable();
  void list_short_edges();
  void begin_burst();
  void place_patch();
  void draw_sets();
  void place_contacts();
  void touch(std::size_t first, std::size_t count, float depth);
  void touch_pairs(std::size_t count);
  void scatter(std::size_t count);
  void touch_dear_set();
  void displace_extremely();
  void spoil();
  void draw_budget();
  std::size_t below(std::size_t bound) { return static_cast<std::size_t>(random_() % bound); }
  float uniform() { return static_cast<float>(random_() >> 40) * 0x1p-23F - 1; }

  const ModelView* view_;
  ScriptBounds bounds_;
  ScriptKind script_;
  std::vector<std::uint32_t> touchable_;        ///< increasing
  std::vector<std::uint32_t> shuffled_;         ///< the same in changing order
  std::uint32_t not_touchable_ = layout::none;  ///< a node that is not, if there is one
  std::vector<Pair> short_edges_;               ///< of touchable nodes, shortest first
  std::size_t most_ = 0;                        ///< contacts at once
  std::vector<DearSet> dear_;
  std::mt19937_64 random_;

  // of a burst
  ScriptKind kind_ = ScriptKind::single;
  std::uint32_t remaining_ = 0;
  std::uint32_t age_ = 0;
  bool unlimited_ = false;
  float direction_[3] = {};
  std::size_t size_ = 0;  ///< contacts
  std::size_t dear_set_ = 0;
  std::size_t shift_ = 0;                      ///< nodes between two sets in turn
  std::vector<std::uint32_t> patch_;           ///< touchable nodes around its centre, nearest first
  std::vector<std::vector<Constraint>> sets_;  ///< those that take turns
  ScriptedStep step_;
};

}  // namespace greenloop
