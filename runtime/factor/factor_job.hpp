#pragma once

#include <cstdint>

#include "runtime/algebra/cholesky.hpp"
#include "runtime/compliance/capacitance.hpp"
#include "runtime/factor/factor_cache.hpp"
#include "runtime/factor/factor_changes.hpp"
#include "runtime/factor/factor_work.hpp"
#include "runtime/memory/arena.hpp"

namespace greenloop {

// Factors are made in three ways: afresh, from a base that some nodes tell from the set, or in slices out of what the
// steps leave of their budgets. From a base, nodes that were let go leave it by rank-one updates, and new ones enter by
// bordering, for which only their columns of the capacitance matrix are computed (James & Pai 2003, section 3.2, do the
// same to an explicit inverse, which loses its symmetry and then its meaning). A set whose factor does not fit a step
// enters in batches of nodes, as many as the scratch has room for: their columns are assembled, coefficient by
// coefficient, then the factor is bordered node by node (Golub & Van Loan, Matrix Computations, section 6.5.4). Between
// two nodes it is the factor of a set, so nodes that are let go meanwhile leave it like any other.

/// Memory that factors are made in.
struct FactorScratch {
  std::uint32_t* order = nullptr;  ///< [columns] nodes of the factor, then those that enter
  Float4* border = nullptr;        ///< [N * stride / 4] of the node that enters
  std::uint64_t spent = 0;         ///< work units that make_factor counts

  /// Arrays out of `arena` for sets of `columns`; null while it counts.
  template <unsigned N>
  void carve(Arena& arena, std::uint32_t columns) noexcept;
};

/// What the factors of a body are made with.
template <unsigned N>
struct FactorTools {
  const FactorCounts& counts;
  const Refinement& refinement;
  const ColumnCosts& cost;
  const std::uint32_t* stored;  ///< [domain] blocks of all layers in a coefficient's column
  FactorCache& cache;
  CapacitanceScratch<N>& capacitance;
  FactorScratch& scratch;
  Vector<N>* force;               ///< [domain], 0 before and after
  std::uint32_t* index_of_place;  ///< [domain], layout::none before and after
  CholeskyFactor cholesky_factor = fastest_cholesky_factor();
};

/// A factor that is made in slices.
struct FactorJob {
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
  template <unsigned N>
  void carve(Arena& arena, const ModelView& view, std::uint32_t columns_of_a_set, bool keeps_capacitance) noexcept;
};

/// Makes the factor of a set in the place of the least recently used one, from changes.base or, where `changes` is
/// null, afresh. Null if the matrix is not positive definite. To be kept in the cache afterwards. touched: by the set;
/// no batch may be at work. For the loop; work: factor_work, or update_factor_work, of which what
/// factor_bounded_work or update_bounded_work bounds is what tools.scratch.spent grows by.
template <unsigned N>
[[nodiscard]] Factor* make_factor(const FactorTools<N>& tools, ColumnSet set, const Touched& touched,
                                  const FactorChanges* changes) noexcept;

/// What a slice may do.
struct Slice {
  std::uint64_t allowance = 0;  ///< work units
  bool moving = false;  ///< contacts change: no more nodes are begun together than the slice completes, if it does one
  bool keeps_parts = false;  ///< what enters goes into the cache although other nodes are missing
};

/// What a slice has done.
struct FactorProgress {
  std::uint64_t work = 0;     ///< spent
  std::uint64_t pending = 0;  ///< bound of what is left; 0: the factor is in the cache, or there is none
};

/// Continues, within its allowance, the factor of a set, or begins it with the nearest cached one. whole: what the
/// set's fresh factor takes. The allowance is used up but for less than the next of: compare_factors_work,
/// begin_batch_work, the blocks of one coefficient in a layer or the diagonal (add_capacitance_blocks), enter_work.
/// Nodes whose matrix turned out not to be positive definite are not begun again: of a set with all of them nothing is
/// pending. For the loop.
template <unsigned N>
FactorProgress continue_factor(FactorJob& job, const FactorTools<N>& tools, ColumnSet set, const SetCounts& whole,
                               const Slice& slice) noexcept;

/// Work units of drop_batch.
[[nodiscard]] std::uint64_t drop_batch_work(const Prices& prices, const FactorJob& job) noexcept;

/// Forgets the batch that is at work, so that the scratch is free. For the loop.
template <unsigned N>
void drop_batch(FactorJob& job, CapacitanceScratch<N>& capacitance) noexcept;

}  // namespace greenloop
