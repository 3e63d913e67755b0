#pragma once

#include <cstdint>
#include <span>

#include "runtime/elastostatic/contact_set.hpp"
#include "runtime/elastostatic/last_answer.hpp"
#include "runtime/memory/arena.hpp"

namespace greenloop {

/// Which contacts of a coarser set are resolved at the finest level although not all can be: whole groups, of those
/// that share a column, the largest force of the last answer first (docs/how_a_step_works.md compares other orders). A
/// group that is chosen stays before others unless their force is twice as large, lest the set change with every
/// tremor.
class Mixture {
 public:
  /// Arrays out of `arena`; null while it counts.
  void carve(Arena& arena, std::uint32_t contacts) noexcept;

  /// Work units of rank, and of choosing groups.
  static constexpr std::uint64_t choose_work(const Prices& prices, std::uint64_t contacts) {
    return priced(contacts, prices.ranked_contact) + priced(merge_sort_steps(contacts), prices.sorted);
  }

  /// Ranks the groups of a set of one constraint level; none is chosen. last: knows the last answer. For the loop;
  /// work: within choose_work.
  void rank(std::span<const Constraint> contacts, const ContactSet& set, const NodeFacts* facts,
            const LastAnswer& last) noexcept;

  [[nodiscard]] std::uint32_t groups() const noexcept { return groups_; }

  /// The column of the g-th group.
  [[nodiscard]] std::uint32_t column(std::uint32_t g) const noexcept { return column_[order_[g]]; }

  /// Contacts of the g-th group.
  [[nodiscard]] std::span<const std::uint32_t> contacts_of(std::uint32_t g) const noexcept {
    const std::uint32_t k = order_[g];
    return {member_ + begin_[k], begin_[k + 1] - begin_[k]};
  }

  /// Whether some of the g-th group were chosen last.
  [[nodiscard]] bool was_chosen(std::uint32_t g) const noexcept { return kept_[order_[g]]; }

  /// Chooses the g-th group. For the loop; work: within choose_work.
  void choose(std::uint32_t g) noexcept;

  /// Marks the nodes of the chosen groups of a level, or none, in place of those of the last choice. For the loop;
  /// work: within choose_work.
  void remember(bool answered, std::uint32_t level, std::span<const Constraint> contacts, NodeFacts* facts) noexcept;

  /// Whether there was a last choice.
  [[nodiscard]] bool has_last() const noexcept { return last_ > 0; }

  /// The level of its groups.
  [[nodiscard]] std::uint32_t last_level() const noexcept { return last_level_; }

  /// [contacts] of those that rank was given: whether they are chosen.
  [[nodiscard]] const bool* fine() const noexcept { return fine_; }

 private:
  void list_members(const ContactSet& set, std::size_t contacts) noexcept;

  std::uint32_t groups_ = 0;
  std::uint32_t* column_ = nullptr;     ///< [groups]
  std::uint32_t* begin_ = nullptr;      ///< [groups + 1] into member_
  std::uint32_t* member_ = nullptr;     ///< [contacts] by groups
  std::uint32_t* order_ = nullptr;      ///< [groups]
  std::uint32_t* sorting_ = nullptr;    ///< [groups] scratch
  float* weight_ = nullptr;             ///< [groups]
  bool* kept_ = nullptr;                ///< [groups] some were chosen last
  bool* fine_ = nullptr;                ///< [contacts]
  std::uint32_t* last_node_ = nullptr;  ///< [contacts] that were chosen last
  std::uint32_t last_ = 0;
  std::uint32_t last_level_ = 0;
};

}  // namespace greenloop
