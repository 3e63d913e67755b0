#pragma once

#include <cstdint>

#include "runtime/compliance/capacitance.hpp"
#include "runtime/elastostatic/step_work.hpp"
#include "runtime/factor/factor_cache.hpp"
#include "runtime/factor/factor_update.hpp"
#include "runtime/memory/arena.hpp"

namespace greenloop {

struct Body;

// A set whose factor does not fit a step is factored in slices, out of what the steps leave of their budgets. Batches
// of nodes, as many as the scratch has room for, enter a factor: their columns of the capacitance matrix are assembled,
// coefficient by coefficient, then the factor is bordered node by node (Golub & Van Loan, Matrix Computations, section
// 6.5.4). Between two nodes it is the factor of a set, so nodes that are let go meanwhile leave it like any other
// (factor_update.hpp).

struct PendingFactor {
  Factor factor;                    ///< of the nodes that are in it; without columns: not begun
  std::uint32_t* column = nullptr;  ///< [columns] sorted, those after the batch
  std::uint32_t columns = 0;
  bool singular = false;     ///< they are not positive definite
  Touched touched;           ///< by those
  SetCounts counts;          ///< of those
  PartialCapacitance batch;  ///< computed: nodes of the batch, 0: none is at work
  std::uint32_t entered = 0;
  std::uint64_t spent = 0;  ///< work units on the batch
  FactorChanges changes;    ///< what tells the factor from the set, within a step

  /// Arrays out of `arena` for sets of `columns`; null while it counts.
  void carve(Arena& arena, const ModelView& view, std::uint32_t columns_of_a_set) noexcept;
};

/// Work units of comparing a set with the factors that there are.
[[nodiscard]] std::uint64_t compare_factors_work(std::uint64_t factors, std::uint64_t columns) noexcept;

/// Work units of beginning a batch for a set that differs from a factor by `removed` nodes and those of the batch.
[[nodiscard]] std::uint64_t begin_batch_work(const ModelCounts& model, const SetCounts& set,
                                             std::uint64_t removed) noexcept;

/// Work units of bordering the factor of a whole set by a node.
[[nodiscard]] std::uint64_t enter_work(const SetCounts& set, std::uint64_t columns_before) noexcept;

/// Work units that a slice may spend, beside giving up a batch: every piece of it fits.
[[nodiscard]] std::uint64_t most_slice_work(const ModelCounts& model, const SetCounts& whole) noexcept;

/// Bound of the work units until a factor has the changes, and all the missing nodes, of `whole`; 0: there are none.
[[nodiscard]] std::uint64_t pending_work(const ModelCounts& model, const SetCounts& whole,
                                         const FactorChanges& changes) noexcept;

/// The same of a factor that is not begun.
[[nodiscard]] std::uint64_t pending_work(const ModelCounts& model, const SetCounts& whole) noexcept;

struct PendingProgress {
  std::uint64_t work = 0;     ///< spent
  std::uint64_t pending = 0;  ///< bound of what is left; 0: the factor is in the cache, or there is none
};

/// Continues, within `allowance` units, the factor of body.set, or begins it with the nearest cached one. whole: of
/// body.set, what its fresh factor takes. An allowance is used up but for less than the next of: compare_factors_work,
/// begin_batch_work, the blocks of one coefficient in a layer (add_capacitance_blocks), enter_work. Nodes whose matrix
/// turned out not to be positive definite are not begun again: of a set with all of them nothing is pending. For the
/// loop.
PendingProgress continue_factor(Body& body, const SetCounts& whole, std::uint64_t allowance) noexcept;

/// Work units of drop_batch.
[[nodiscard]] std::uint64_t drop_batch_work(const PendingFactor& pending) noexcept;

/// Forgets the batch that is at work, so that body.capacitance and body.update are free. For the loop.
void drop_batch(Body& body) noexcept;

}  // namespace greenloop
