#pragma once

#include <cstdint>

#include "runtime/compliance/capacitance_work.hpp"
#include "runtime/factor/factor_cache.hpp"
#include "runtime/wavelet/column.hpp"

namespace greenloop {

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

/// Whether a factor and a set may have columns in common: sets of different levels have none. For the loop; work:
/// within list_changes'.
[[nodiscard]] bool may_share_columns(const Factor& factor, ColumnSet set) noexcept;

/// What tells a factor from a set; base stays null if more than FactorChanges::most nodes have to leave.
/// For the loop; work: two units a column and one for each change.
void list_changes(Factor& factor, ColumnSet set, FactorChanges& changes) noexcept;

/// The cached factor that fewest nodes tell from a set. For the loop; work: find_changes_work.
void find_changes(const FactorCache& cache, ColumnSet set, FactorChanges& nearest) noexcept;

/// Work units of find_changes.
constexpr std::uint64_t find_changes_work(const Prices& prices, std::uint64_t factors, std::uint64_t columns) {
  return priced(factors * columns, prices.near_column) + priced(factors, prices.near_factor);
}

/// What the work of an update follows from.
struct ChangeCounts {
  std::uint64_t added = 0;
  std::uint64_t removed = 0;
  ColumnSums entering;  ///< over the new nodes
};

/// cost: of each column; touched: by the set. For the loop; work: within find_changes'.
[[nodiscard]] ChangeCounts count_changes(const FactorChanges& changes, const ColumnCosts& cost,
                                         const Touched& touched) noexcept;

}  // namespace greenloop
