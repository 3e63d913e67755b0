#pragma once

#include <cstdint>
#include <span>

#include "runtime/constraint.hpp"
#include "runtime/elastostatic/contact_set.hpp"
#include "runtime/mask.hpp"
#include "runtime/memory/arena.hpp"
#include "runtime/prices.hpp"
#include "runtime/wavelet/force_transform.hpp"
#include "runtime/wavelet/reach.hpp"

namespace greenloop {

/// The known forces of a step, node by node: those of masks are spread over theirs. Nodes may occur more than once.
struct KnownForces {
  std::uint32_t count = 0;
  std::uint32_t* node = nullptr;    ///< [forces]
  std::uint32_t* column = nullptr;  ///< [forces] that stand for those at the level of the plan
  float* force = nullptr;           ///< [3 * forces] N, over the stiffness scale
  Touched touched;                  ///< by the columns

  /// Arrays out of `arena`; null while it counts.
  void carve(Arena& arena, const ModelView& view, std::uint32_t forces) noexcept;

  [[nodiscard]] ColumnForces on_columns() const noexcept { return {count, column, force}; }
};

/// The masks that constraints name.
struct Masks {
  std::span<const Mask> scalar;
  std::span<const DirectedMask> directed;
};

/// Entries that the known forces of some constraints have. For the loop; work: a unit a constraint.
[[nodiscard]] std::uint64_t count_forces(std::span<const Constraint> constraints, const Masks& masks) noexcept;

/// Work units of checking constraints and loads and of list_forces; forces: nodes with known ones, those of masks each
/// time.
constexpr std::uint64_t check_loaded_work(const Prices& prices, std::uint64_t constraints, std::uint64_t forces) {
  return check_contacts_work(prices, constraints + forces) + priced(2, prices.step) +
         priced(constraints + forces, prices.force_column);
}

/// Lists the known forces among checked constraints, and the nodes that are held in `held`; returns how many those are.
/// Whether the forces overflow is left to the caller: their magnitudes are added to `sum`. For the loop.
std::uint32_t list_forces(std::span<const Constraint> constraints, const Masks& masks, float stiffness,
                          KnownForces& forces, Constraint* held, float& sum) noexcept;

/// Resolves them at a level. For the loop; work: Prices::resolved_contact each.
void resolve_forces(const ModelView& view, const NodeFacts* facts, std::uint32_t level, KnownForces& forces) noexcept;

}  // namespace greenloop
