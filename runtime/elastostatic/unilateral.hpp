#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/constraint.hpp"
#include "runtime/elastostatic/contact_set.hpp"
#include "runtime/factor/factor.hpp"
#include "runtime/friction/contact_problem.hpp"
#include "runtime/friction/local_model.hpp"
#include "runtime/memory/arena.hpp"
#include "runtime/prices.hpp"
#include "runtime/vec.hpp"

namespace greenloop {

/// A node of a unilateral contact's point.
struct UnilateralCorner {
  std::uint32_t hold;  ///< by its place among UnilateralScratch::hold
  float weight;
};

/// Memory of unilateral contacts.
struct UnilateralScratch {
  Constraint* hold = nullptr;             ///< [corners] the nodes of all contacts, each once, as holds
  UnilateralCorner* corner = nullptr;     ///< [corners] of one contact after the other
  std::uint32_t* begin = nullptr;         ///< [contacts + 1] the corners of each
  std::uint32_t* hold_of_node = nullptr;  ///< [nodes] none between uses
  float* hold_force = nullptr;            ///< [3 * corners] N, over the stiffness scale
  std::uint32_t* contact = nullptr;       ///< [contacts] those that columns hold
  std::uint32_t held = 0;                 ///< how many these are, in the last answer
  ContactCandidate* candidate = nullptr;  ///< [contacts] of these
  Vec4* force = nullptr;                  ///< [contacts] N, of these
  Vec4* gap = nullptr;                    ///< [contacts] m, of these
  ContactState* state = nullptr;          ///< [contacts] of these
  ContactCompliance compliance;           ///< between these
  ContactProblem problem;
  LocalModelBuilder builder;
  ToolPoint* point = nullptr;  ///< [contacts] of these

  /// Arrays out of `arena`, for so many contacts with as many corners in all; null while it counts.
  void carve(Arena& arena, std::uint32_t contacts, std::uint32_t nodes, const Prices& prices) noexcept;
};

/// Work units of list_unilateral.
constexpr std::uint64_t list_unilateral_work(const Prices& prices, std::uint64_t contacts, std::uint64_t corners) {
  return priced(contacts + 3 * corners, prices.checked_contact);
}

/// Refuses contacts of which Elastostatic::step says so, but for what check_contacts finds out of their nodes, and
/// lists their nodes; how many: `holds`. most: corners in all.
CheckedContacts list_unilateral(std::span<const UnilateralContact> contacts, std::uint32_t node_count,
                                std::uint32_t most, UnilateralScratch& scratch, std::uint32_t& holds) noexcept;

/// The first contact that one of the holds is of. Linear in the corners.
[[nodiscard]] std::uint32_t contact_of(const UnilateralScratch& scratch, std::uint32_t hold) noexcept;

/// Unilateral contacts of a step, listed, and the columns of their nodes.
struct UnilateralSet {
  std::span<const UnilateralContact> contacts;
  const ContactSet& set;
  const float* displaced = nullptr;  ///< [3 * columns] m, without contact forces; null: by nothing
  float stiffness = 1;               ///< scale that forces are over
};

/// Work units of solve_unilateral but for ContactProblem::solve.
[[nodiscard]] std::uint64_t gather_unilateral_work(const Prices& prices, std::uint64_t corners) noexcept;

/// Work units of solve_unilateral with what so many iterations take at least, which are one or more. corners: no less
/// than contacts.
[[nodiscard]] std::uint64_t unilateral_work(const Prices& prices, std::uint64_t corners,
                                            std::uint64_t iterations) noexcept;

/// The forces of unilateral contacts with friction on the compliance that a factor keeps; none for those of which a
/// column waits. allowance: units of ContactProblem::solve. column_force: [3 * columns] their sums. For the loop; work:
/// gather_unilateral_work and what ContactProblem says.
ContactAnswer solve_unilateral(const UnilateralSet& all, const Factor& factor, std::uint32_t stride,
                               const ContactAccuracy& accuracy, std::uint64_t allowance, UnilateralScratch& scratch,
                               float* column_force) noexcept;

/// Puts nodes that are contacts by themselves where their answer says, in a field that lacks details; of a set at the
/// finest level. displacement: of the nodes that are displaced. For the loop; linear in the corners.
void place_contacts(const UnilateralSet& all, const UnilateralScratch& scratch, std::span<Vec4> displacement) noexcept;

/// Where an answer goes.
struct UnilateralOutput {
  std::span<Vec3> force;  ///< [contacts] N
  std::span<ContactState> state;
  std::span<Vec4> gap;
  std::span<float> yield;
  std::span<Vec4> by_loads;
};

/// Writes what it found: also hold_force. For the loop; linear in the corners.
void hand_out_unilateral(const UnilateralSet& all, UnilateralScratch& scratch, const UnilateralOutput& output) noexcept;

}  // namespace greenloop
