#pragma once

#include <cstdint>

#include "formats/view.hpp"
#include "runtime/wavelet/column.hpp"
#include "runtime/wavelet/prediction.hpp"
#include "runtime/wavelet/reach.hpp"
#include "runtime/wavelet/refinement.hpp"

namespace greenloop {

// What a capacitance matrix takes (capacitance.hpp), from counts.

/// What a column of the capacitance matrix costs.
struct ColumnCost {
  std::uint32_t coefficients = 0;  ///< of its functional
  std::uint32_t blocks = 0;        ///< stored blocks in the lists of those, over all layers
  std::uint32_t visits = 0;        ///< of touch
};

/// Costs summed over some columns.
struct ColumnSums {
  std::uint64_t coefficients = 0;
  std::uint64_t blocks = 0;
  std::uint64_t visits = 0;

  void add(const ColumnCost& cost) noexcept {
    coefficients += cost.coefficients;
    blocks += cost.blocks;
    visits += cost.visits;
  }
};

/// The costs of all columns.
struct ColumnCosts {
  const ColumnCost* level[layout::max_levels] = {};  ///< [c][domain nodes of K(c)]

  [[nodiscard]] const ColumnCost& of(std::uint32_t column) const noexcept {
    return level[column_level(column)][column_place(column)];
  }
};

/// Pairs of so many rows, of which the last may have one.
constexpr std::uint64_t pairs(std::uint64_t rows) { return (rows + 1) / 2; }

/// Rows of the matrix that are summed together, at least; even.
inline constexpr std::uint32_t least_batch = 16;

/// Pairs of sums that a scratch has for the largest set, of so many slots and columns.
constexpr std::uint64_t capacitance_room(std::uint64_t slots, std::uint32_t columns) {
  return slots * pairs(columns < least_batch ? columns : least_batch);
}

/// Adds the blocks, of all layers, that level q stores to the counts of both of their coefficients, of those before
/// `end`. degree: [end]. Start-up.
void add_degrees(const ModelView& view, std::uint32_t q, std::uint32_t end, std::uint32_t* degree) noexcept;

/// What a column of level c costs. degree: by levels 0..c, as add_degrees counts. Start-up.
[[nodiscard]] ColumnCost column_cost(const Refinement& refinement, std::uint32_t column, const std::uint32_t* degree,
                                     Touched& touched) noexcept;

/// What the work of assemble_capacitance follows from.
struct CapacitanceCounts {
  const Prices* prices = nullptr;
  Prediction prediction{};
  std::uint64_t columns = 0;       ///< of the set
  std::uint64_t rows = 0;          ///< that are computed
  std::uint64_t slots = 0;         ///< of the set
  std::uint64_t set_visits = 0;    ///< of touching them
  std::uint64_t stored = 0;        ///< blocks in the columns of those in all layers
  std::uint64_t visits = 0;        ///< ColumnCost summed over the rows that are computed
  std::uint64_t coefficients = 0;  ///< the same
  std::uint64_t blocks = 0;        ///< the same
  std::uint64_t room = 0;          ///< of the scratch
  bool bounds = false;             ///< of any set, not of one
};

/// Rows that are summed together by functionals: as many as the scratch has room for. slots: positive.
constexpr std::uint64_t batch_width(std::uint64_t room, std::uint64_t slots) {
  const std::uint64_t width = 2 * (room / slots);
  return width > least_batch ? width : least_batch;
}

/// Whether the scratch holds the couplings of all slots beside the sums of the rows that are computed.
constexpr bool has_panel(std::uint64_t room, std::uint64_t slots, std::uint64_t rows) {
  return slots * (pairs(slots) + pairs(rows)) <= room;
}

/// Work units of T^-1 of the couplings of two coefficients with the computed rows, and of listing these. own_visits: of
/// touching those.
constexpr std::uint64_t panel_pair_work(const Prices& prices, const Prediction& prediction, std::uint64_t own_visits,
                                        std::uint64_t rows) {
  return priced(own_visits, pair_visit_price(prices, prediction)) + priced(rows, prices.panel_row);
}

/// Work units of T^-1 of two rows of sums. set_visits: of touching the set.
constexpr std::uint64_t sum_pair_work(const Prices& prices, const Prediction& prediction, std::uint64_t set_visits) {
  return priced(set_visits, pair_visit_price(prices, prediction));
}

/// Work units of begin_capacitance.
[[nodiscard]] std::uint64_t begin_capacitance_work(const CapacitanceCounts& counts) noexcept;

/// Bound of the work units of add_capacitance_blocks until no blocks are left.
[[nodiscard]] std::uint64_t add_capacitance_blocks_work(const CapacitanceCounts& counts) noexcept;

/// The same of all batches of assemble_capacitance.
[[nodiscard]] std::uint64_t assemble_blocks_work(const CapacitanceCounts& counts) noexcept;

/// Work units of store_capacitance_row.
constexpr std::uint64_t store_capacitance_work(const Prices& prices, std::uint64_t columns) {
  return priced(columns, prices.stored_entry);
}

/// What assemble_capacitance takes besides.
[[nodiscard]] std::uint64_t begin_assembly_work(const CapacitanceCounts& counts) noexcept;

/// Bound of the work units of assemble_capacitance: both.
[[nodiscard]] std::uint64_t assemble_capacitance_work(const CapacitanceCounts& counts) noexcept;

/// Slots of a set: the coefficients that it touches, and its columns that are coarser than the finest. For the loop;
/// work: a unit a column.
[[nodiscard]] std::uint32_t count_slots(const ColumnSet& set, const Touched& touched) noexcept;

}  // namespace greenloop
