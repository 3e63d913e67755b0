#pragma once

#include <cstdint>

#include "runtime/compliance/capacitance.hpp"
#include "runtime/elastostatic/contact_set.hpp"
#include "runtime/elastostatic/step_work.hpp"
#include "runtime/factor/factor_cache.hpp"
#include "runtime/memory/arena.hpp"

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
  std::uint32_t missing = 0;     ///< nodes to be added in all; `added` are the first `most` of them
  std::uint32_t in[most] = {};   ///< the added columns, increasing
  std::uint32_t out[most] = {};  ///< of the removed ones
};

/// Memory of update_factor.
struct FactorUpdateScratch {
  std::uint32_t* order = nullptr;  ///< [columns] nodes of the factor, then added ones
  Float4* border = nullptr;        ///< [3 * stride / 4] of the node that enters

  /// Arrays out of `arena` for sets of `columns`; null while it counts.
  void carve(Arena& arena, std::uint32_t columns) noexcept;
};

/// Whether a factor and a set may have columns in common: sets of different levels have none. For the loop; work:
/// within list_changes'.
[[nodiscard]] bool may_share_columns(const Factor& factor, const ContactSet& set) noexcept;

/// What tells a factor from a set; base stays null if more than FactorChanges::most nodes have to leave.
/// For the loop; work: two units a column and one for each change.
void list_changes(Factor& factor, const ContactSet& set, FactorChanges& changes) noexcept;

/// The cached factor that fewest nodes tell from a set. For the loop; work: find_changes_work.
void find_changes(const FactorCache& cache, const ContactSet& set, FactorChanges& nearest) noexcept;

/// Work units of find_changes.
constexpr std::uint64_t find_changes_work(std::uint64_t factors, std::uint64_t columns) {
  return factors * (2 * columns + FactorChanges::most);
}

/// What the work of an update follows from.
struct ChangeCounts {
  std::uint64_t added = 0;
  std::uint64_t removed = 0;
  ColumnSums entering;  ///< over the new nodes
};

/// cost: of each column. For the loop; work: within find_changes'.
[[nodiscard]] ChangeCounts count_changes(const FactorChanges& changes, const ColumnCosts& cost) noexcept;

/// Work units of update_factor, the columns of the new nodes included.
[[nodiscard]] std::uint64_t update_factor_work(const ModelCounts& model, const SetCounts& set,
                                               const ChangeCounts& changes) noexcept;

/// Whose coefficients are touched, and what computes their capacitance.
struct CapacitanceSource {
  const Refinement& refinement;
  const Touched& touched;
  CapacitanceScratch& scratch;
  Float4* force;  ///< [domain], 0 before and after
};

/// Copies what a factor holds into another with room for it. For the loop; work: half the square of its order.
void copy_factor(const Factor& from, std::uint32_t stride, Factor& to) noexcept;

/// Takes a node out of a factor. border: of a FactorUpdateScratch. For the loop; work: cholesky_remove_work, and a unit
/// a column.
void remove_node(std::uint32_t node, std::uint32_t stride, Factor& factor, Float4* border) noexcept;

/// Borders a factor by a node. border: its rows of the capacitance matrix of the factor's nodes and itself, up to the
/// diagonal. False if it is not positive definite; then it is spoilt. For the loop; work: cholesky_append_work.
[[nodiscard]] bool append_node(std::uint32_t node, std::uint32_t stride, Factor& factor, Float4* border) noexcept;

/// Lists where the set's columns stand in its factor. For the loop; work: two units a column.
void list_positions(const ContactSet& set, Factor& factor) noexcept;

/// Makes the set's factor out of changes.base, in the place of the least recently used one. Null if it is not positive
/// definite. To be kept afterwards. For the loop; work: update_factor_work.
[[nodiscard]] Factor* update_factor(FactorCache& cache, const ContactSet& set, const FactorChanges& changes,
                                    const CapacitanceSource& source, FactorUpdateScratch& scratch) noexcept;

}  // namespace greenloop
