#pragma once

#include <cstdint>

#include "runtime/compliance/capacitance_work.hpp"
#include "runtime/factor/factor_changes.hpp"

namespace greenloop {

/// What the work of factors follows from, beside their sets.
struct FactorCounts {
  Prices prices{};
  std::uint32_t cached_factors = 0;
  bool keeps_capacitance = false;
  std::uint64_t capacitance_room = 0;  ///< of CapacitanceScratch
  Prediction prediction{};

  /// Rows of a matrix of so many columns.
  [[nodiscard]] std::uint32_t order(std::uint64_t columns) const noexcept {
    return static_cast<std::uint32_t>(prediction.components * columns);
  }
};

/// What a set of columns holds.
struct SetCounts {
  std::uint64_t contacts = 0;
  std::uint64_t columns = 0;
  std::uint64_t corners = 0;     ///< of unilateral or mixed contacts, at least one each; 0: nodes are held
  std::uint64_t iterations = 0;  ///< that solve for unilateral ones, at least
  std::uint64_t rows = 0;        ///< that mixed ones hold; 0: they are not mixed
  // what follows only if a field is wanted or a factor is to be made
  std::uint64_t coefficients = 0;  ///< that the columns touch, none counted twice
  std::uint64_t visits = 0;        ///< of touching them
  // and this only for a factor
  std::uint64_t slots = 0;   ///< of the capacitance matrix
  std::uint64_t stored = 0;  ///< blocks of all layers in those columns
  ColumnSums column;         ///< over all columns
  bool bounds = false;       ///< of any set that holds no more, not of one
};

/// Work units of finding the coefficients that a set touches and counting what its factor takes.
[[nodiscard]] std::uint64_t touch_work(const Prices& prices, const SetCounts& set) noexcept;

/// Work units of counting the blocks of a field.
[[nodiscard]] std::uint64_t count_field_work(const Prices& prices, const SetCounts& set) noexcept;

/// What the whole capacitance matrix of a set takes.
[[nodiscard]] CapacitanceCounts capacitance_counts(const FactorCounts& model, const SetCounts& set) noexcept;

/// Work units of a capacitance factor.
[[nodiscard]] std::uint64_t factor_work(const FactorCounts& model, const SetCounts& set) noexcept;

/// What bounds, within it, the work units of the blocks of its capacitance matrix.
[[nodiscard]] std::uint64_t factor_bounded_work(const FactorCounts& model, const SetCounts& set) noexcept;

/// Adds to `counts` what the factor of a resolved set takes, whose coefficients are touched. stored: [domain] blocks of
/// all layers in each coefficient's column.
void count_factor(ColumnSet set, const Touched& touched, const ColumnCosts& cost, const std::uint32_t* stored,
                  SetCounts& counts) noexcept;

/// Work units of make_factor from a base, the columns of the new nodes included.
[[nodiscard]] std::uint64_t update_factor_work(const FactorCounts& model, const SetCounts& set,
                                               const ChangeCounts& changes) noexcept;

/// What bounds, within it, the work units of the blocks of those columns and of the nodes that leave and enter.
[[nodiscard]] std::uint64_t update_bounded_work(const FactorCounts& model, const SetCounts& set,
                                                const ChangeCounts& changes) noexcept;

// The pieces of continue_factor (factor_job.hpp).

/// Work units of comparing a set with the factors that there are.
[[nodiscard]] std::uint64_t compare_factors_work(const FactorCounts& model, std::uint64_t columns) noexcept;

/// Nodes that enter a factor together: as many rows of their matrix as the scratch has room for.
[[nodiscard]] std::uint64_t most_in_a_batch(const FactorCounts& model, const SetCounts& whole) noexcept;

/// The same, but no more than a slice can both begin and complete, so that what follows moving contacts keeps what has
/// entered; as many as a batch holds if it can complete none. allowance: units after the batch is begun.
[[nodiscard]] std::uint64_t most_in_a_slice(const FactorCounts& model, const SetCounts& whole,
                                            std::uint64_t allowance) noexcept;

/// Bound of the work units of so many nodes that leave a factor of a set and those.
[[nodiscard]] std::uint64_t leave_work(const FactorCounts& model, std::uint64_t columns,
                                       std::uint64_t removed) noexcept;

/// Bound of the work units of beginning a batch for a set that differs from a factor by `removed` nodes and those of
/// the batch. It holds leave_work and most_begin_rows_work.
[[nodiscard]] std::uint64_t begin_batch_work(const FactorCounts& model, const SetCounts& set,
                                             std::uint64_t removed) noexcept;

/// Bound of begin_rows_work for any batch of a whole set.
[[nodiscard]] std::uint64_t most_begin_rows_work(const FactorCounts& model, const SetCounts& whole) noexcept;

/// Work units of touching a set and beginning the rows of the nodes among it that enter.
[[nodiscard]] std::uint64_t begin_rows_work(const FactorCounts& model, const SetCounts& set,
                                            const ChangeCounts& changes) noexcept;

/// Work units of bordering the factor of a whole set by a node.
[[nodiscard]] std::uint64_t enter_work(const FactorCounts& model, const SetCounts& set,
                                       std::uint64_t columns_before) noexcept;

/// Work units that a slice may spend, beside giving up a batch: every piece of it fits.
[[nodiscard]] std::uint64_t most_slice_work(const FactorCounts& model, const SetCounts& whole) noexcept;

/// Bound of the work units until a factor has the changes, and all the missing nodes, of `whole`; 0: there are none.
[[nodiscard]] std::uint64_t pending_work(const FactorCounts& model, const SetCounts& whole,
                                         const FactorChanges& changes) noexcept;

/// The same of a factor that is not begun.
[[nodiscard]] std::uint64_t pending_work(const FactorCounts& model, const SetCounts& whole) noexcept;

}  // namespace greenloop
