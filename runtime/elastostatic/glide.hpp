#pragma once

#include <cstdint>
#include <span>

#include "formats/layout.hpp"
#include "runtime/elastostatic/contact_set.hpp"
#include "runtime/elastostatic/last_answer.hpp"
#include "runtime/memory/arena.hpp"

namespace greenloop {

/// What a step's report says about a change of level.
struct GlideReport {
  float share = 1;
  float difference = 0;  ///< N
  double work = 0;       ///< J, as of StepDetails::switch_work
};

/// Leads the forces from one constraint level to another in equal parts of their difference. While both can be solved,
/// the forces are (1 - s) K_old u + s K_new u of the present displacements u, with s growing by 1 / cycles: both are
/// symmetric and positive definite, so is their mixture, and a change of s stores 1/2 ds (f_new - f_old) . u. Else the
/// last known difference is kept and let go in the same parts: the stiffness is the newer level's at once. So is that
/// of what was answered while contacts waited that now are held, in a quarter of the cycles. Differences belong to
/// nodes: contacts that are new have none. There is no glide, and one under way ends, where fewer than three quarters
/// of the contacts persist: forces change with the contacts then, and a difference of other contacts would only falsify
/// them.
class Glide {
 public:
  /// Arrays out of `arena`; null while it counts. cycles: of a whole glide, at least 1; with 1 there is none.
  void carve(Arena& arena, std::uint32_t contacts, std::uint32_t cycles) noexcept;

  /// Takes this step's contacts as they are resolved. For the loop; work: within blend's.
  void advance(std::span<const Constraint> contacts, const ContactSet& set, const LastAnswer& last) noexcept;

  /// Ends a glide that is under way: the answer is of one level alone. For the loop; constant work.
  void stop(std::uint32_t level) noexcept {
    moving_ = kept_ = fresh_ = foreseen_ = false;
    left_ = 0;
    kept_weight_ = 0;
    foreseen_level_ = layout::none;
    to_ = level;
  }

  /// Whether the forces of `older_level` are wanted.
  [[nodiscard]] bool follows() const noexcept { return moving_ && !kept_ && cycles_ > 1; }
  [[nodiscard]] std::uint32_t older_level() const noexcept { return from_; }

  /// Work units of advance and blend, and of LastAnswer::remember.
  static constexpr std::uint64_t blend_work(const Prices& prices, std::uint64_t contacts) {
    return priced(contacts, prices.blended_contact);
  }

  /// force: [3 * contacts] of the newer level, becomes the answer. older: of the older level, or null: they are not
  /// known. For the loop.
  GlideReport blend(std::span<const Constraint> contacts, const LastAnswer& last, const float* older,
                    float* force) noexcept;

  /// What `level` answers to the contacts of the last answer: if the next step is answered there, its glide begins with
  /// the difference of the two, whatever the contacts do meanwhile. force: [3 * contacts]. For the loop; work: within
  /// blend's.
  void foresee(std::uint32_t level, const LastAnswer& last, const float* force) noexcept;

 private:
  void turn_back(std::uint32_t contacts) noexcept;

  std::uint32_t cycles_ = 1;
  std::uint32_t span_ = 1;  ///< cycles of this glide: a quarter where contacts come in that waited
  std::uint32_t left_ = 0;  ///< cycles until the newer level stands alone
  std::uint32_t from_ = 0;
  std::uint32_t to_ = 0;
  bool moving_ = false;    ///< this step's share differs from that of the last
  bool fresh_ = false;     ///< this step begins a glide
  bool kept_ = false;      ///< the difference is kept, not computed
  float kept_weight_ = 0;  ///< of a kept difference in the last answer
  bool foreseen_ = false;  ///< this step begins a glide whose difference was
  std::uint32_t foreseen_level_ = layout::none;
  float* foreseen_difference_ = nullptr;  ///< [3 * contacts] by place in the last answer
  float* difference_ = nullptr;           ///< [3 * contacts] by place in the last answer
  float* next_difference_ = nullptr;      ///< [3 * contacts] scratch
};

}  // namespace greenloop
