#pragma once

#include <cstdint>

#include "runtime/arena.hpp"
#include "runtime/capacitance.hpp"
#include "runtime/contact_set.hpp"
#include "runtime/factor_cache.hpp"
#include "runtime/plan.hpp"

namespace greenloop {

// A cached factor follows its contact set: nodes that were let go leave it by rank-one updates, new ones enter by
// bordering, for which only their columns of the capacitance matrix are computed (James & Pai 2003, section 3.2, do the
// same to an explicit inverse, which loses its symmetry and then its meaning).

/// How a cached factor differs from a set.
struct FactorChanges {
  static constexpr std::uint32_t most = 16;             ///< nodes in, and nodes out
  static constexpr std::uint32_t most_in_a_row = 4096;  ///< changes of a factor before a fresh one is asked for

  Factor* base = nullptr;  ///< null: no factor is near enough
  std::uint32_t added = 0;
  std::uint32_t removed = 0;
  std::uint32_t in[most] = {};   ///< places of the added nodes, increasing
  std::uint32_t out[most] = {};  ///< of the removed ones
};

/// Memory of update_factor.
struct FactorUpdateScratch {
  std::uint32_t* order = nullptr;  ///< [columns] added nodes, then those of the factor
  Float4* columns = nullptr;       ///< [3 * FactorChanges::most * stride / 4]
  Float4* border = nullptr;        ///< [3 * stride / 4]

  /// Arrays out of `arena` for sets of `columns`; null while it counts.
  void carve(Arena& arena, std::uint32_t columns) noexcept;
};

/// The cached factor of the set's level that fewest nodes tell from it. For the loop; work: find_changes_work.
[[nodiscard]] FactorChanges find_changes(const FactorCache& cache, const ContactSet& set) noexcept;

/// Work units of find_changes.
constexpr std::uint64_t find_changes_work(std::uint64_t factors, std::uint64_t columns) {
  return factors * (2 * columns + FactorChanges::most);
}

/// Work units of update_factor, the columns of the new nodes included. cost: of each node as a column of the level.
[[nodiscard]] std::uint64_t update_factor_work(const SetCounts& set, const FactorChanges& changes,
                                               const ColumnCost* cost) noexcept;

/// Whose coefficients are touched, and what computes their capacitance.
struct CapacitanceSource {
  const Refinement& refinement;
  const Touched& touched;
  CapacitanceScratch& scratch;
  Float4* force;  ///< [domain], 0 before and after
};

/// Makes the set's factor out of changes.base, in the place of the least recently used one. Null if it is not positive
/// definite. To be kept afterwards. For the loop; work: update_factor_work.
[[nodiscard]] Factor* update_factor(FactorCache& cache, const ContactSet& set, const FactorChanges& changes,
                                    const CapacitanceSource& source, FactorUpdateScratch& scratch) noexcept;

}  // namespace greenloop
