#pragma once

#include <bit>
#include <cstdint>
#include <span>

#include "formats/view.hpp"
#include "runtime/algebra/merge_sort.hpp"
#include "runtime/constraint.hpp"
#include "runtime/loop.hpp"
#include "runtime/mask.hpp"
#include "runtime/memory/arena.hpp"
#include "runtime/prices.hpp"
#include "runtime/wavelet/column.hpp"

namespace greenloop {

/// What the loop looks up about a node.
struct NodeFacts {
  std::uint8_t mesh_level = 0;
  bool touchable = false;  ///< a node of every constraint level stands for it
  bool marked = false;     ///< by check_contacts, while it looks for duplicates
};

/// Facts of every node; facts: [node_count]. Start-up; linear in nodes.
void list_node_facts(const ModelView& view, NodeFacts* facts) noexcept;

/// Whether a displacement is known, and the force sought.
constexpr bool is_contact(const Constraint& constraint) {
  return constraint.kind == Constraint::Kind::hold || constraint.kind == Constraint::Kind::normal ||
         constraint.kind == Constraint::Kind::mask;
}

/// What check_contacts finds: the first fault and the contact that has it, by its place among them.
struct CheckedContacts {
  Status status = Status::ok;
  std::uint32_t refused = StepReport::no_constraint;
};

/// Work units of check_contacts.
constexpr std::uint64_t check_contacts_work(const Prices& prices, std::uint64_t contacts) {
  return priced(1, prices.step) + priced(contacts, prices.checked_contact);
}

/// What a body takes in a step. Nodes of masks count each time.
struct ConstraintBounds {
  std::uint32_t contacts = 0;
  std::uint32_t forces = 0;     ///< nodes with known ones; 0: the kinds are refused
  std::span<const Mask> masks;  ///< that there are
  std::span<const DirectedMask> directed{};
  bool mixed = false;  ///< contacts may be of kinds normal and mask
};

/// Refuses constraints of kinds that are not known, out of range, not touchable, not finite, nodes named twice, and
/// more than `bounds` has; the first at fault decides.
CheckedContacts check_contacts(std::span<const Constraint> contacts, std::uint32_t node_count, NodeFacts* facts,
                               const ConstraintBounds& bounds) noexcept;

/// The same where nothing but nodes may be held, so many at most.
[[nodiscard]] CheckedContacts check_holds(std::span<const Constraint> contacts, std::uint32_t node_count,
                                          NodeFacts* facts, std::uint32_t most) noexcept;

/// Displacements smaller than this count as none, in m: keeps denormal numbers out of the loop.
inline constexpr float least_displacement = 0x1p-80F;
constexpr float without_tiny(float displacement) {
  // no branch on data: the same instructions for every number
  const std::uint32_t tiny = static_cast<std::uint32_t>(displacement < least_displacement) &
                             static_cast<std::uint32_t>(displacement > -least_displacement);
  return std::bit_cast<float>(std::bit_cast<std::uint32_t>(displacement) & (tiny - 1));
}

/// The contacts of a step as columns: the nodes of one constraint level that stand for them. Contacts that share a
/// column are merged.
struct ContactSet {
  std::uint32_t columns = 0;         ///< columns that hold them
  std::uint32_t waiting = 0;         ///< contacts that none of them holds
  std::uint32_t* column = nullptr;   ///< [columns] increasing, of distinct places
  std::uint32_t* place = nullptr;    ///< [contacts] of each contact's column in `column`; layout::none: it waits
  std::uint32_t* members = nullptr;  ///< [columns] contacts merged into it

  /// Arrays out of `arena`; null while it counts.
  void carve(Arena& arena, std::uint32_t contacts) noexcept;

  [[nodiscard]] ColumnSet all() const noexcept { return {columns, column}; }

  /// Constraint level of its columns; of a set that has some.
  [[nodiscard]] std::uint32_t level() const noexcept { return column_level(column[0]); }

  /// Whether a column holds a contact.
  [[nodiscard]] bool holds(std::size_t contact) const noexcept { return place[contact] != layout::none; }
};

/// What contacts are resolved with.
struct ResolutionScratch {
  std::uint32_t* sorting = nullptr;         ///< [contacts]
  std::uint32_t* index_of_place = nullptr;  ///< [domain], `layout::none` between calls

  /// Arrays out of `arena`; null while it counts.
  void carve(Arena& arena, std::uint32_t contacts, std::uint64_t domain) noexcept;
};

/// Bound of the work units of resolve_contacts: linear but for a merge sort.
constexpr std::uint64_t resolve_contacts_work(const Prices& prices, std::uint64_t contacts) {
  return priced(contacts, prices.resolved_contact) + priced(merge_sort_steps(contacts), prices.sorted);
}

/// The column that stands for a touchable node on a constraint level. For the loop; work: constant.
[[nodiscard]] std::uint32_t column_of(const ModelView& view, const NodeFacts* facts, std::uint32_t node,
                                      std::uint32_t level) noexcept;

/// Resolves checked contacts at a level that has representatives; none waits.
void resolve_contacts(std::span<const Constraint> contacts, const ModelView& view, const NodeFacts* facts,
                      std::uint32_t level, ResolutionScratch& scratch, ContactSet& set) noexcept;

/// Takes columns out of a set, some of it, increasing: their contacts wait. For the loop; work: within
/// resolve_contacts_work.
void leave_out(ColumnSet columns, std::size_t contacts, ResolutionScratch& scratch, ContactSet& set) noexcept;

/// displacement[3 * columns]: mean over each column's contacts.
void average_displacements(std::span<const Constraint> contacts, const ContactSet& set, float* displacement) noexcept;

/// contact_force[3 * contacts]: each column's force in equal parts, so that the total is kept; none for those that
/// wait.
void share_forces(const float* column_force, std::size_t contacts, const ContactSet& set,
                  float* contact_force) noexcept;

}  // namespace greenloop
