#include "runtime/compliance/capacitance_work.hpp"

#include <algorithm>

#include "runtime/algebra/merge_sort.hpp"

namespace greenloop {
namespace {

std::uint64_t smaller(std::uint64_t a, std::uint64_t b) { return a < b ? a : b; }
std::uint64_t larger(std::uint64_t a, std::uint64_t b) { return a > b ? a : b; }

// of touching the computed rows alone; the steps of T^-1 have no more terms
std::uint64_t own_visits(const CapacitanceCounts& counts) { return smaller(counts.set_visits, counts.visits); }

bool panel_of(const CapacitanceCounts& counts) { return has_panel(counts.room, counts.slots, counts.rows); }

// of listing the steps of T^-1 for the set; with a panel of some of its rows that is done after the panel
std::uint64_t list_work(const CapacitanceCounts& counts) { return list_set_work(*counts.prices, counts.set_visits); }
bool lists_after_panel(const CapacitanceCounts& counts) { return panel_of(counts) && counts.rows < counts.columns; }

// most slots of a set that has a panel
std::uint64_t most_panel_slots(const CapacitanceCounts& counts) {
  std::uint64_t slots = counts.slots;
  while (slots * slots > 2 * counts.room) {
    slots = (slots + 2 * counts.room / slots) / 2;  // Newton's iteration falls to the root
  }
  return slots;
}

// what every batch of rows begins with
std::uint64_t begin_batch_work(const CapacitanceCounts& counts) {
  const Prices& prices = *counts.prices;
  return priced(1, prices.batch) + priced(own_visits(counts), prices.listed_visit) +
         (lists_after_panel(counts) && !counts.bounds ? 0 : list_work(counts)) + priced(counts.slots, prices.slot) +
         priced(merge_sort_steps(counts.rows), prices.sorted);
}

std::uint64_t functionals_work(const CapacitanceCounts& counts) {
  const Prices& prices = *counts.prices;
  const std::uint64_t transforms = counts.prediction.blocks ? counts.prediction.components : 1;
  return priced(counts.visits, prices.functional_visit) +
         priced(transforms * counts.visits, force_visit_price(prices, counts.prediction)) +
         priced(transforms * counts.coefficients, prices.functional) +
         priced(counts.rows * counts.slots, prices.cleared);
}

// of the blocks in the columns of the slots, at most one of each two; those that no functional meets are passed over
std::uint64_t stored_work(const CapacitanceCounts& counts) {
  const Prices& prices = *counts.prices;
  const std::uint64_t between = smaller(counts.stored, counts.slots * (counts.slots + 1) / 2);
  return priced(layout::layers * counts.slots, prices.layer) + priced(counts.slots, prices.diagonal) +
         priced(counts.stored, prices.stored_block) + priced(smaller(between, counts.meetings), prices.scaled_block);
}

// a functional meets the blocks of others, and on the diagonal that of each of its own coefficients
std::uint64_t meetings_work(const CapacitanceCounts& counts) {
  return priced(counts.meetings + counts.coefficients, meeting_price(*counts.prices, counts.prediction));
}

std::uint64_t panel_work(const CapacitanceCounts& counts, std::uint64_t slots) {
  return pairs(slots) * panel_pair_work(*counts.prices, counts.prediction, own_visits(counts), counts.rows);
}

std::uint64_t whole_work(const CapacitanceCounts& counts) {
  return begin_assembly_work(counts) + assemble_blocks_work(counts);
}

// what sets of so many columns that have a panel hold at most: all that the bounds hold, of which each column has its
// share, and no more slots than a panel has; without lifting each of these is predicted once
CapacitanceCounts bound_with_panel(const CapacitanceCounts& bounds, std::uint64_t columns, std::uint64_t slots) {
  CapacitanceCounts counts = bounds;
  counts.columns = counts.rows = columns;
  counts.visits = bounds.visits / bounds.rows * columns;
  counts.coefficients = bounds.coefficients / bounds.rows * columns;
  counts.slots = smaller(slots, counts.coefficients);
  counts.set_visits = smaller(bounds.set_visits, counts.visits);
  if (!bounds.prediction.lifted) {
    counts.set_visits = smaller(counts.set_visits, columns + bounds.prediction.length * counts.slots);
  }
  return counts;
}

// of any set that holds no more; bounds.visits and coefficients: as many for each row
std::uint64_t bound_of_whole(CapacitanceCounts bounds) {
  bounds.bounds = false;
  std::uint64_t most = whole_work(bounds);
  if (panel_of(bounds)) {
    return most;
  }
  std::uint64_t slots = most_panel_slots(bounds);
  for (std::uint64_t columns = 1; columns <= bounds.rows; ++columns) {
    while (!has_panel(bounds.room, slots, columns)) {
      --slots;
    }
    most = larger(most, whole_work(bound_with_panel(bounds, columns, slots)));
  }
  return most;
}

// of rows, in which they are summed
std::uint64_t batches(const CapacitanceCounts& counts) {
  const std::uint64_t width = batch_width(counts.room, counts.slots > 0 ? counts.slots : 1);
  return panel_of(counts) ? 1 : (counts.rows + width - 1) / width;
}

}  // namespace

void ColumnSums::add(const ColumnCosts& costs, std::uint32_t column, const Touched& touched) noexcept {
  const ColumnCost& cost = costs.of(column);
  const std::uint32_t* const blocks = costs.blocks_of(column);
  coefficients += cost.coefficients;
  visits += cost.visits;
  for (std::uint32_t q = 0; q <= column_level(column); ++q) {
    meetings += most_meetings(blocks[q], cost.coefficients, touched.count[q]);
  }
}

ColumnCost column_cost(const Refinement& refinement, std::uint32_t column, const std::uint32_t* degree,
                       Touched& touched, std::uint32_t* blocks) noexcept {
  touch(refinement, &column, 1, touched);
  ColumnCost cost;
  cost.visits = static_cast<std::uint32_t>(touched.visits);
  std::fill_n(blocks, column_level(column) + 1, 0);
  for (std::uint32_t q = 0; q <= touched.finest; ++q) {
    cost.coefficients += touched.count[q];
    for (std::uint32_t k = 0; k < touched.count[q]; ++k) {
      const std::uint32_t* const of_levels = degree + std::size_t{refinement.view->levels} * touched.list[q][k];
      for (std::uint32_t with = 0; with <= column_level(column); ++with) {
        blocks[with] += of_levels[with];
      }
    }
  }
  clear(touched);
  return cost;
}

std::uint64_t begin_capacitance_work(const CapacitanceCounts& counts) noexcept {
  const std::uint64_t slots = counts.bounds ? most_panel_slots(counts) : counts.slots;
  const std::uint64_t panel = panel_of(counts) || counts.bounds ? priced(slots * slots, counts.prices->cleared) : 0;
  const std::uint64_t functionals = panel_of(counts) ? 0 : functionals_work(counts);
  return begin_batch_work(counts) + (panel > functionals ? panel : functionals);
}

std::uint64_t add_capacitance_blocks_work(const CapacitanceCounts& counts) noexcept {
  const std::uint64_t slots = counts.bounds ? most_panel_slots(counts) : counts.slots;
  return stored_work(counts) +
         pairs(counts.rows) * sum_pair_work(*counts.prices, counts.prediction, counts.set_visits) +
         (panel_of(counts) ? 0 : meetings_work(counts)) +
         (lists_after_panel(counts) || counts.bounds ? list_work(counts) : 0) +
         (panel_of(counts) || counts.bounds ? panel_work(counts, slots) : 0);
}

std::uint64_t assemble_blocks_work(const CapacitanceCounts& counts) noexcept {
  return counts.rows == 0 ? 0 : add_capacitance_blocks_work(counts) + (batches(counts) - 1) * stored_work(counts);
}

std::uint64_t begin_assembly_work(const CapacitanceCounts& counts) noexcept {
  if (counts.rows == 0) {
    return 0;
  }
  return begin_capacitance_work(counts) + (batches(counts) - 1) * begin_batch_work(counts) +
         counts.rows * store_capacitance_work(*counts.prices, counts.columns);
}

std::uint64_t assemble_capacitance_work(const CapacitanceCounts& counts) noexcept {
  if (counts.rows == 0) {
    return 0;
  }
  return counts.bounds ? bound_of_whole(counts) : whole_work(counts);
}

std::uint32_t count_slots(const ColumnSet& set, const Touched& touched) noexcept {
  auto slots = static_cast<std::uint32_t>(touched.coefficients());
  for (std::uint32_t i = 0; i < set.count; ++i) {
    slots += column_level(set.column[i]) < touched.finest ? 1 : 0;
  }
  return slots;
}

}  // namespace greenloop
