#pragma once

#include <cstddef>
#include <cstdint>

#include "formats/stored_blocks.hpp"
#include "formats/view.hpp"
#include "runtime/wavelet/column.hpp"
#include "runtime/wavelet/domain.hpp"
#include "runtime/wavelet/prediction.hpp"
#include "runtime/wavelet/reach.hpp"
#include "runtime/wavelet/refinement.hpp"

namespace greenloop {

// What a capacitance matrix takes (capacitance.hpp), from counts.

/// What a column of the capacitance matrix costs.
struct ColumnCost {
  std::uint32_t coefficients = 0;  ///< of its functional
  std::uint32_t visits = 0;        ///< of touch
};

/// Bound of the blocks of some coefficients of a functional with those of one level that a set touches: no more than
/// there are, and no more than one with each.
constexpr std::uint64_t most_meetings(std::uint64_t blocks, std::uint64_t coefficients, std::uint64_t touched) {
  return blocks < coefficients * touched ? blocks : coefficients * touched;
}

/// The costs of all columns.
struct ColumnCosts {
  const ColumnCost* level[layout::max_levels] = {};      ///< [c][domain nodes of K(c)]
  const std::uint32_t* blocks[layout::max_levels] = {};  ///< [c][domain nodes of K(c)][c + 1] of all layers, by the
                                                         ///< level of the coefficient that a functional's have it with

  [[nodiscard]] const ColumnCost& of(std::uint32_t column) const noexcept {
    return level[column_level(column)][column_place(column)];
  }
  [[nodiscard]] const std::uint32_t* blocks_of(std::uint32_t column) const noexcept {
    const std::uint32_t c = column_level(column);
    return blocks[c] + std::size_t{c + 1} * column_place(column);
  }
};

/// Costs summed over some columns of a set.
struct ColumnSums {
  std::uint64_t coefficients = 0;
  std::uint64_t meetings = 0;  ///< bound of the blocks of the functionals' coefficients with those that the set touches
  std::uint64_t visits = 0;

  void add(const ColumnCosts& costs, std::uint32_t column, const Touched& touched) noexcept;
};

/// Pairs of so many rows, of which the last may have one.
constexpr std::uint64_t pairs(std::uint64_t rows) { return (rows + 1) / 2; }

/// Rows of the matrix that are summed together, at least; even.
inline constexpr std::uint32_t least_batch = 16;

/// Pairs of sums that a scratch has for the largest set, of so many slots and columns.
constexpr std::uint64_t capacitance_room(std::uint64_t slots, std::uint32_t columns) {
  return slots * pairs(columns < least_batch ? columns : least_batch);
}

/// Calls visit(coefficient, level) for either coefficient before `end` of every block, of all layers, that level q
/// stores; level: of the other one. Start-up.
template <class Visit>
void visit_degrees(const ModelView& view, std::uint32_t q, std::uint32_t end, Visit visit) {
  const LevelView& level = view.level[q];
  for (const CouplingsView& couplings : level.couplings) {
    for (std::uint32_t j = 0; j < couplings.columns; ++j) {
      const std::uint32_t column = level.domain_begin + j;
      std::uint32_t row_level = 0;
      visit_rows(couplings, j, 0, column < end ? column : end, [&](std::uint32_t row, std::uint32_t) {
        while (row >= domain_up_to(view, row_level)) {
          ++row_level;
        }
        visit(row, q);
        if (column < end) {
          visit(column, row_level);
        }
      });
    }
  }
}

/// What a column of level c costs. degree: [domain][levels] blocks of each coefficient with those of each level;
/// blocks: [c + 1], as ColumnCosts has them. Start-up.
[[nodiscard]] ColumnCost column_cost(const Refinement& refinement, std::uint32_t column, const std::uint32_t* degree,
                                     Touched& touched, std::uint32_t* blocks) noexcept;

/// What the work of assemble_capacitance follows from.
struct CapacitanceCounts {
  const Prices* prices = nullptr;
  Prediction prediction{};
  std::uint64_t columns = 0;       ///< of the set
  std::uint64_t rows = 0;          ///< that are computed
  std::uint64_t slots = 0;         ///< of the set
  std::uint64_t set_visits = 0;    ///< of touching them
  std::uint64_t stored = 0;        ///< blocks in the columns of those in all layers
  std::uint64_t visits = 0;        ///< ColumnSums of the rows that are computed
  std::uint64_t coefficients = 0;  ///< the same
  std::uint64_t meetings = 0;      ///< the same
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

/// Work units of listing the steps of T^-1 for a set.
constexpr std::uint64_t list_set_work(const Prices& prices, std::uint64_t set_visits) {
  return priced(set_visits, prices.set_visit);
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
