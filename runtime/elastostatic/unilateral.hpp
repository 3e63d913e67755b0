#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/constraint.hpp"
#include "runtime/contact/contact_problem.hpp"
#include "runtime/elastostatic/contact_set.hpp"
#include "runtime/elastostatic/last_answer.hpp"
#include "runtime/factor/factor.hpp"
#include "runtime/memory/arena.hpp"
#include "runtime/prices.hpp"
#include "runtime/vec.hpp"

namespace greenloop {

/// Memory of solve_unilateral.
struct UnilateralScratch {
  Constraint* hold = nullptr;             ///< [contacts] the same nodes, held at their values
  std::uint32_t* contact = nullptr;       ///< [contacts] those that columns hold
  ContactCandidate* candidate = nullptr;  ///< [contacts] of these
  Vec4* force = nullptr;                  ///< [contacts] N, of these
  ContactCompliance compliance;           ///< between these
  ContactProblem problem;

  /// Arrays out of `arena`, for so many contacts; null while it counts.
  void carve(Arena& arena, std::uint32_t contacts) noexcept;
};

/// Work units of check_unilateral, which enters the holds.
constexpr std::uint64_t check_unilateral_work(const Prices& prices, std::uint64_t contacts) {
  return priced(contacts, prices.resolved_contact);
}

/// Refuses contacts whose normal is not of unit length within 1e-3, or whose friction is negative or not finite, and
/// writes what they are as holds. hold: [contacts].
CheckedContacts check_unilateral(std::span<const UnilateralContact> contacts, Constraint* hold) noexcept;

/// Unilateral contacts of a step, as the columns that they would be if they were held.
struct UnilateralSet {
  std::span<const UnilateralContact> contacts;
  const ContactSet& set;
  const float* displaced = nullptr;  ///< [3 * columns] m, without contact forces; null: by nothing
};

/// Work units of an iteration.
[[nodiscard]] std::uint64_t unilateral_iteration_work(const Prices& prices, std::uint64_t contacts) noexcept;

/// Work units of solve_unilateral with so many iterations, at least one.
[[nodiscard]] std::uint64_t unilateral_work(const Prices& prices, std::uint64_t contacts,
                                            std::uint64_t iterations) noexcept;

/// The forces of unilateral contacts with friction, from the last answer's on, on the compliance that a factor keeps;
/// none for those that wait. column_force: [3 * columns], their sums. For the loop; work: unilateral_work of as many
/// iterations as it says.
ContactAnswer solve_unilateral(const UnilateralSet& all, const Factor& factor, std::uint32_t stride,
                               const LastAnswer& last, const ContactAccuracy& accuracy, UnilateralScratch& scratch,
                               float* column_force) noexcept;

/// The forces that it found: [3 * contacts] N. For the loop; linear in them.
void unilateral_forces(const UnilateralScratch& scratch, const ContactSet& set, std::size_t contacts,
                       float* force) noexcept;

/// Brings forces back into their cones, along the surface. force: [3 * contacts]. For the loop; linear in them.
void push_only(std::span<const UnilateralContact> contacts, float* force) noexcept;

/// What each contact does, by its force. For the loop; linear in them.
void list_states(std::span<const UnilateralContact> contacts, const float* force,
                 std::span<ContactState> state) noexcept;

}  // namespace greenloop
