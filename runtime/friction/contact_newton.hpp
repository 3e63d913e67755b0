#pragma once

#include <cstdint>

#include "runtime/friction/contact_compliance.hpp"
#include "runtime/friction/friction.hpp"
#include "runtime/memory/arena.hpp"

namespace greenloop {

/// Candidates of a contact problem: [count] each.
struct ContactPoints {
  std::uint32_t count = 0;
  const FrictionContact* contact = nullptr;
  const Float4* gap = nullptr;  ///< m, without forces
  ContactCompliance compliance;
};

/// One contact's law, linearised: which of the three states it is in, and, where it slips, in which direction.
struct FrozenContact {
  ContactState state = ContactState::open;
  Float4 push{};      ///< slipping: the force for a unit of normal force, N/N
  Float4 across{};    ///< slipping: unit, tangential, across the friction force
  float sliding = 1;  ///< slipping, 0 .. 1: how much the slip across weighs against the force across
};

/// A semismooth Newton step for the whole law (Alart & Curnier 1991): every contact is frozen in the state that the
/// natural map sees it in, and the linear system, which friction makes unsymmetric, is solved by GMRES (Saad & Schultz
/// 1986) with each contact's own block as the preconditioner on the right. Modes in which all contacts move together,
/// which sweeps over single contacts hardly see, take one vector each.
class ContactNewton {
 public:
  static constexpr std::uint32_t most_vectors = 24;

  /// Arrays out of `arena`; null while it counts.
  void carve(Arena& arena, std::uint32_t candidates) noexcept;

  /// From forces and their displacements, gaps included, to new forces and displacements. vectors: 1 .. most_vectors,
  /// how many may be used. Returns how many were: the system is solved to a hundredth where they suffice. Forces
  /// may leave the friction cones. For the loop; work: vectors + 2 products with the compliance, and vectors^2
  /// multiply-adds of three numbers a candidate.
  std::uint32_t step(const ContactPoints& points, std::uint32_t vectors, Float4* force, Float4* displacement) noexcept;

 private:
  [[nodiscard]] float freeze(const ContactPoints& points, Float4* force, Float4* displacement) noexcept;
  [[nodiscard]] float expand(const ContactPoints& points, std::uint32_t k, float* products) noexcept;
  void add_solution(const ContactPoints& points, std::uint32_t vectors, const float* weight, Float4* force) noexcept;

  FrozenContact* frozen_ = nullptr;
  Float4* direction_ = nullptr;            ///< a vector of the subspace, preconditioned
  Float4* vector_[most_vectors + 1] = {};  ///< orthonormal
};

}  // namespace greenloop
