#include "runtime/factor/factor_work.hpp"

#include "runtime/algebra/cholesky.hpp"

namespace greenloop {
namespace {

// of copying the capacitance matrix of so many rows where it is kept
std::uint64_t kept_work(const FactorCounts& model, std::uint64_t order) {
  return model.keeps_capacitance ? priced(order * order / 2, model.prices.passed) : 0;
}

// bounds for any batch of a set
CapacitanceCounts batch_counts(const FactorCounts& model, const SetCounts& whole) {
  CapacitanceCounts counts = capacitance_counts(model, whole);
  counts.bounds = counts.bounds || !has_panel(counts.room, counts.slots, counts.rows);
  return counts;
}

// of the rows of the nodes that enter
CapacitanceCounts entering_counts(const FactorCounts& model, const SetCounts& set, const ChangeCounts& changes) {
  CapacitanceCounts counts = capacitance_counts(model, set);
  counts.rows = changes.added;
  counts.visits = changes.entering.visits;
  counts.coefficients = changes.entering.coefficients;
  counts.meetings = changes.entering.meetings;
  return counts;
}

}  // namespace

std::uint64_t touch_work(const Prices& prices, const SetCounts& set) noexcept {
  return priced(set.visits, prices.visit) + priced(set.coefficients, prices.touched) + count_field_work(prices, set);
}

std::uint64_t count_field_work(const Prices& prices, const SetCounts& set) noexcept {
  return priced(set.coefficients, prices.counted);
}

CapacitanceCounts capacitance_counts(const FactorCounts& model, const SetCounts& set) noexcept {
  return {.prices = &model.prices,
          .prediction = model.prediction,
          .columns = set.columns,
          .rows = set.columns,
          .slots = set.slots,
          .set_visits = set.visits,
          .stored = set.stored,
          .visits = set.column.visits,
          .coefficients = set.column.coefficients,
          .meetings = set.column.meetings,
          .room = model.capacitance_room,
          .bounds = set.bounds};
}

std::uint64_t factor_work(const FactorCounts& model, const SetCounts& set) noexcept {
  const std::uint32_t order = model.order(set.columns);
  return priced(1, model.prices.factor) + FactorCache::find_work(model.prices, model.cached_factors, set.columns) +
         priced(2 * set.columns, model.prices.placed_column) +
         assemble_capacitance_work(capacitance_counts(model, set)) + kept_work(model, order) +
         cholesky_factor_work(model.prices, order);
}

std::uint64_t factor_bounded_work(const FactorCounts& model, const SetCounts& set) noexcept {
  return assemble_blocks_work(capacitance_counts(model, set));
}

void count_factor(ColumnSet set, const Touched& touched, const ColumnCosts& cost, const std::uint32_t* stored,
                  SetCounts& counts) noexcept {
  counts.coefficients = touched.coefficients();
  counts.visits = touched.visits;
  counts.slots = count_slots(set, touched);
  for (std::uint32_t k = 0; k < set.count; ++k) {
    counts.column.add(cost, set.column[k], touched);
  }
  for (std::uint32_t q = 0; q <= touched.finest; ++q) {
    for (std::uint32_t k = 0; k < touched.count[q]; ++k) {
      counts.stored += stored[touched.list[q][k]];
    }
  }
}

std::uint64_t leave_work(const FactorCounts& model, std::uint64_t columns, std::uint64_t removed) noexcept {
  const std::uint32_t order = model.order(columns + removed);
  return removed * cholesky_remove_work(model.prices, order, 0, model.prediction.components);
}

std::uint64_t update_bounded_work(const FactorCounts& model, const SetCounts& set,
                                  const ChangeCounts& changes) noexcept {
  const std::uint32_t order = model.order(set.columns + changes.removed);
  return assemble_blocks_work(entering_counts(model, set, changes)) + leave_work(model, set.columns, changes.removed) +
         changes.added * cholesky_append_work(model.prices, order, model.prediction.components);
}

std::uint64_t update_factor_work(const FactorCounts& model, const SetCounts& set,
                                 const ChangeCounts& changes) noexcept {
  const std::uint32_t components = model.prediction.components;
  const std::uint32_t order = model.order(set.columns + changes.removed);
  const std::uint64_t kept = (1 + changes.removed) * kept_work(model, order);
  const Prices& prices = model.prices;
  const std::uint64_t appended = model.keeps_capacitance ? priced(std::uint64_t{components} * order, prices.passed) : 0;
  return priced(1, prices.factor) + kept + priced(std::uint64_t{order} * order / 2, prices.passed) +
         changes.added * appended + priced((6 + changes.removed) * set.columns, prices.placed_column) +
         begin_assembly_work(entering_counts(model, set, changes)) + update_bounded_work(model, set, changes);
}

std::uint64_t most_in_a_batch(const FactorCounts& model, const SetCounts& whole) noexcept {
  return batch_width(model.capacitance_room, whole.coefficients > 0 ? whole.coefficients : 1);
}

std::uint64_t most_in_a_slice(const FactorCounts& model, const SetCounts& whole, std::uint64_t allowance) noexcept {
  const std::uint64_t most = most_in_a_batch(model, whole);
  const auto batch_of = [&](std::uint64_t rows) {
    CapacitanceCounts counts = capacitance_counts(model, whole);
    counts.rows = rows;
    counts.visits = counts.visits * rows / whole.columns;
    counts.coefficients = counts.coefficients * rows / whole.columns;
    counts.meetings = counts.meetings * rows / whole.columns;
    return add_capacitance_blocks_work(counts) + rows * enter_work(model, whole, whole.columns);
  };
  const std::uint64_t one = batch_of(1);
  if (most == 1 || one > allowance) {
    return most;
  }
  const std::uint64_t row = (batch_of(most) - one) / (most - 1);
  const std::uint64_t rows = 1 + (allowance - one) / (row > 0 ? row : 1);
  return rows < most ? rows : most;
}

std::uint64_t compare_factors_work(const FactorCounts& model, std::uint64_t columns) noexcept {
  return find_changes_work(model.prices, model.cached_factors + std::uint64_t{4}, columns);
}

std::uint64_t begin_batch_work(const FactorCounts& model, const SetCounts& set, std::uint64_t removed) noexcept {
  const std::uint64_t columns = set.columns + removed;
  const std::uint32_t order = model.order(columns);
  const Prices& prices = model.prices;
  return (1 + removed) * kept_work(model, order) + priced(std::uint64_t{order} * order / 2, prices.passed) +
         leave_work(model, set.columns, removed) + priced((12 + 2 * removed) * columns, prices.placed_column) +
         most_begin_rows_work(model, set);
}

std::uint64_t most_begin_rows_work(const FactorCounts& model, const SetCounts& whole) noexcept {
  return touch_work(model.prices, whole) + begin_capacitance_work(batch_counts(model, whole));
}

std::uint64_t begin_rows_work(const FactorCounts& model, const SetCounts& set, const ChangeCounts& changes) noexcept {
  return touch_work(model.prices, set) + begin_capacitance_work(entering_counts(model, set, changes));
}

std::uint64_t enter_work(const FactorCounts& model, const SetCounts& set, std::uint64_t columns_before) noexcept {
  const std::uint32_t components = model.prediction.components;
  const Prices& prices = model.prices;
  const std::uint64_t entries = std::uint64_t{components} * components * (columns_before + 1);
  const std::uint64_t kept = model.keeps_capacitance ? priced(entries, prices.passed) : 0;
  return kept + store_capacitance_work(prices, set.columns) + priced(columns_before, prices.placed_column) +
         cholesky_append_work(prices, model.order(columns_before), components);
}

std::uint64_t most_slice_work(const FactorCounts& model, const SetCounts& whole) noexcept {
  const std::uint64_t fresh = factor_work(model, whole);
  const std::uint64_t begin = begin_batch_work(model, whole, FactorChanges::most);
  return compare_factors_work(model, whole.columns) + (fresh > begin ? fresh : begin);
}

std::uint64_t pending_work(const FactorCounts& model, const SetCounts& whole, const FactorChanges& changes) noexcept {
  const std::uint64_t missing = changes.missing;
  const std::uint64_t most = most_in_a_batch(model, whole);
  const std::uint64_t adding = (missing + most - 1) / most;
  const std::uint64_t batches = adding == 0 && changes.removed > 0 ? 1 : adding;
  CapacitanceCounts counts = batch_counts(model, whole);
  const std::uint64_t once = add_capacitance_blocks_work(counts);
  counts.rows = 0;  // each row is in one batch
  counts.meetings = counts.stored;
  const std::uint64_t blocks = adding > 0 ? once + (adding - 1) * add_capacitance_blocks_work(counts) : 0;
  return batches * begin_batch_work(model, whole, changes.removed) + blocks +
         missing * enter_work(model, whole, whole.columns);
}

std::uint64_t pending_work(const FactorCounts& model, const SetCounts& whole) noexcept {
  FactorChanges changes;
  changes.missing = static_cast<std::uint32_t>(whole.columns);
  return pending_work(model, whole, changes);
}

}  // namespace greenloop
