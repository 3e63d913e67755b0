#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/constraint.hpp"
#include "runtime/elastostatic/contact_set.hpp"
#include "runtime/elastostatic/glide.hpp"
#include "runtime/elastostatic/known_forces.hpp"
#include "runtime/elastostatic/last_answer.hpp"
#include "runtime/factor/factor.hpp"
#include "runtime/memory/arena.hpp"
#include "runtime/prices.hpp"
#include "runtime/vec.hpp"

namespace greenloop {

// Contacts of a step of which some hold masks, or hold along directions alone. Each holds one row or three of what its
// nodes do: D u = v, by forces D^T x, so that x is found on the projected compliance D U D^T, which is positive
// definite where no row of D is a sum of others (James & Pai 2001, section 6.2: the compliance of a mask). U stands
// beside the factor of the nodes, whatever the directions are, and is cached and changed with it; what is projected is
// factored in each step.

/// A node of a contact, or a column that stands for it.
struct MixedCorner {
  std::uint32_t place;  ///< among the nodes that are held, or the columns
  Vec3 part;            ///< of a directed mask; of what is held in all directions its weight, three times
};

/// A contact, or several that share one column, as one.
struct MixedContact {
  std::uint32_t begin = 0, end = 0;  ///< its corners
  bool directed = false;             ///< one row, not three
  float value[3] = {};               ///< m
  std::uint32_t row = 0;             ///< its first
  std::uint32_t members = 1;
  float square = 0;  ///< of the members' parts, where they are of single nodes

  [[nodiscard]] std::uint32_t rows() const { return directed ? 1 : 3; }
};

/// Memory of mixed contacts, for so many that have as many corners in all.
struct MixedScratch {
  Constraint* hold = nullptr;             ///< [contacts] the nodes of all, each once, as holds
  std::uint32_t* hold_of_node = nullptr;  ///< [nodes] layout::none between uses
  float* hold_force = nullptr;            ///< [3 * contacts] N, over the stiffness scale, in equal parts of a column's
  MixedCorner* corner = nullptr;          ///< [contacts] of one contact after the other
  MixedContact* contact = nullptr;        ///< [contacts]
  std::uint32_t contacts = 0;
  // on the columns of a level
  MixedCorner* column_corner = nullptr;  ///< [contacts]
  MixedContact* joint = nullptr;         ///< [contacts] those that columns hold
  std::uint32_t* joint_of = nullptr;     ///< [contacts] of each; layout::none: it waits
  std::uint32_t* of_column = nullptr;    ///< [2 * contacts] joint of a column alone: held, and directed
  float* matrix = nullptr;               ///< [(3 * contacts)^2] the projected compliance
  float* diagonal = nullptr;             ///< [3 * contacts]
  float* amount = nullptr;               ///< [3 * contacts] N, of the rows
  // of the glide between levels, by place among the contacts
  Constraint* keyed = nullptr;       ///< [contacts] this step's, with their places for nodes
  Constraint* last_named = nullptr;  ///< [contacts] what the last step's named
  std::uint32_t* waits = nullptr;    ///< [contacts] as ContactSet::place
  float* force = nullptr;            ///< [3 * contacts] N, over the stiffness scale
  Glide glide;
  LastAnswer last;

  /// Arrays out of `arena`; null while it counts. cycles: of a glide.
  void carve(Arena& arena, std::uint32_t contacts, std::uint32_t nodes, std::uint32_t cycles) noexcept;
};

/// What mixed contacts count as.
struct MixedCounts {
  std::uint32_t holds = 0;    ///< distinct nodes
  std::uint32_t corners = 0;  ///< each contact has one at least
  std::uint32_t rows = 0;
};

/// Work units of list_mixed.
constexpr std::uint64_t list_mixed_work(const Prices& prices, std::uint64_t constraints, std::uint64_t corners) {
  return priced(constraints + 3 * corners, prices.checked_contact);
}

/// Lists the contacts among checked constraints, and their nodes. For the loop.
MixedCounts list_mixed(std::span<const Constraint> constraints, const Masks& masks, MixedScratch& scratch) noexcept;

/// The columns of the nodes in a planned set, and the factor that keeps the compliance between them.
struct MixedSet {
  const ContactSet& set;
  const Factor& factor;
  std::uint32_t stride = 0;
  const float* displaced = nullptr;  ///< [3 * columns] m, without contact forces; null: by nothing
  bool finest = false;               ///< level of the set
};

/// Work units of solve_mixed and glide_mixed.
[[nodiscard]] std::uint64_t mixed_work(const Prices& prices, std::uint64_t corners, std::uint64_t rows) noexcept;

/// The forces of the contacts; none for those of which a column waits. Below the finest level contacts of single nodes
/// that share a column and are of a kind are held in their mean, by equal parts of its force, and rows that others
/// leave next to nothing of have none. Returns how many rows have none because of others. column_force: [3 * columns].
/// For the loop; work: mixed_work.
std::uint32_t solve_mixed(const MixedSet& all, MixedScratch& scratch, float* column_force) noexcept;

/// Blends the contacts' forces with those of the level before, as Glide does, where the last step had the same
/// contacts. For the loop; work: within mixed_work.
GlideReport glide_mixed(std::span<const Constraint> constraints, const ContactSet& set, MixedScratch& scratch) noexcept;

/// Hands out what was found, times the stiffness scale, and what is known. force: [constraints]. For the loop; linear
/// in them.
void hand_out_mixed(std::span<const Constraint> constraints, const MixedScratch& scratch, float stiffness,
                    std::span<Vec3> force) noexcept;

}  // namespace greenloop
