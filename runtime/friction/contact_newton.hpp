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

/// displacement = gap + compliance times force. For the loop; work: that of `multiply`.
void displace(const ContactPoints& points, const Float4* force, Float4* displacement) noexcept;

/// One contact's law, linearised: which of the three states it is in, and, where it slips, in which direction.
struct FrozenContact {
  ContactState state = ContactState::open;
  Float4 push{};      ///< slipping: the force for a unit of normal force, N/N
  Float4 across{};    ///< slipping: unit, tangential, across the friction force
  float sliding = 1;  ///< slipping, 0 .. 1: how much the slip across it counts
  float holding = 0;  ///< slipping, m/N: how much the force across it does
};

/// A semismooth Newton step for the whole law (Alart & Curnier 1991): every contact is frozen in the state that the
/// natural map sees it in, and the linear system, which friction makes unsymmetric, is solved by GMRES (Saad & Schultz
/// 1986) with each contact's own block as the preconditioner on the right. A mode in which all contacts move together,
/// which sweeps over single contacts hardly see, takes one vector. Of the way to the solution that part is gone, a
/// whole to an eighth, at whose end the natural map is smallest.
class ContactNewton {
 public:
  static constexpr std::uint32_t most_vectors = 24;

  /// Arrays out of `arena`; null while it counts.
  void carve(Arena& arena, std::uint32_t candidates) noexcept;

  struct Terms {
    float weight;           ///< of displacements against forces where states are chosen, times FrictionContact::scale
    float reduction;        ///< of the linear system's residual
    std::uint32_t vectors;  ///< 1 .. most_vectors, for it at most
  };

  /// From forces and their displacements to new ones, [count] each; forces may leave the friction cones. Returns how
  /// many vectors were used. For the loop; work: vectors + 2 times that of `displace`, and vectors^2 multiply-adds of
  /// three numbers a candidate.
  std::uint32_t step(const ContactPoints& points, const Terms& terms, Float4* force, Float4* displacement) noexcept;

  /// Freezes the contacts as they are at a solution. For the loop, linear in the contacts.
  void linearise(const ContactPoints& points, const Float4* force, const Float4* displacement) noexcept;

  /// After `linearise`: what forces and displacements change by when gaps do, [count] each, while no contact changes
  /// its state; displacement: the gaps' change, becomes that of the displacements. Returns how many vectors were
  /// used. For the loop; work: as of `step`.
  std::uint32_t respond(const ContactPoints& points, const Terms& terms, Float4* displacement, Float4* force) noexcept;

 private:
  struct Triangle;
  [[nodiscard]] std::uint32_t add_solution(const ContactPoints& points, const Terms& terms, Float4* force) noexcept;
  [[nodiscard]] float expand(const ContactPoints& points, std::uint32_t k, float* products) noexcept;
  [[nodiscard]] float squared_residual(const ContactPoints& points, float part, const Float4* force,
                                       const Float4* displacement) const noexcept;
  void search(const ContactPoints& points, Float4* force, Float4* displacement) noexcept;

  FrozenContact* frozen_ = nullptr;
  Triangle* triangle_ = nullptr;
  Float4* start_force_ = nullptr;
  Float4* start_displacement_ = nullptr;
  Float4* direction_ = nullptr;            ///< a vector of the subspace, preconditioned
  Float4* vector_[most_vectors + 1] = {};  ///< orthonormal
};

}  // namespace greenloop
