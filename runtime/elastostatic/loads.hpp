#pragma once

#include <cstdint>
#include <span>

#include "runtime/elastostatic.hpp"
#include "runtime/elastostatic/body.hpp"

namespace greenloop {

/// The constraints of a step, the contacts among them, and where the forces of these go.
struct Contacts {
  std::span<const Constraint> all;
  std::span<const Constraint> held;
  float* force = nullptr;  ///< [3 * held] N, over the stiffness scale

  // if they are unilateral ones: what these are, on the nodes that would be held
  std::span<const UnilateralContact> surfaces{};
  UnilateralOutput output{};
  ContactAnswer* found = nullptr;  ///< null: they are held
  std::uint32_t corner_count = 0;

  // if some hold masks, or along directions alone: null if none does
  MixedScratch* mixed = nullptr;
  MixedCounts mixed_counts{};

  /// Each by itself and in all directions.
  [[nodiscard]] bool are_held() const { return found == nullptr && mixed == nullptr; }
  /// Of unilateral ones, which each count as one at least.
  [[nodiscard]] std::uint32_t corners() const {
    const auto contacts = static_cast<std::uint32_t>(surfaces.size());
    return corner_count > contacts ? corner_count : contacts;
  }
};

/// Whether a body takes such loads, but for the masks. For the loop; work: a unit a pressure.
[[nodiscard]] Status check_loads(const Body& body, const Elastostatic::Loads& loads) noexcept;

/// Takes what acts in a step, out of checked constraints, into the body. False if it could overflow the answer. For the
/// loop; work: within check_loaded_work.
bool take_loads(Body& body, std::span<const Constraint> constraints, const Elastostatic::Loads& loads,
                std::span<Vec3> force, Contacts& contacts) noexcept;

/// What forces and loads displace of the columns that `Body::touched` is touched by: LoadState::displaced at their
/// places, to be cleared by it. The forces' own coefficients are touched in LoadState::forces. Returns the blocks
/// between the two. For the loop; work: displace_by_loads_work.
std::uint64_t displace(const Body& body, const ColumnForces& forces, const ActingLoads& acting) noexcept;

/// What the loads of a planned step displace of the columns of its contacts, into LoadState::column_displaced. Returns
/// the blocks between the two. For the loop; work: displace_by_loads_work.
std::uint64_t displace_by_loads(const Body& body) noexcept;

/// Hands the forces of all constraints of an answered step out, and the report's forces and energies, by the stiffness
/// scale; where they stand already, it does nothing. For the loop; work: within check_loaded_work.
void hand_out_forces(const Body& body, const Contacts& contacts, std::span<Vec3> force,
                     Elastostatic::StepReport& report) noexcept;

}  // namespace greenloop
