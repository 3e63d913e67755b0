#include "runtime/compliance/capacitance.hpp"

#include <cstddef>
#include <cstring>

#include "runtime/algebra/merge_sort.hpp"
#include "runtime/algebra/stored_block.hpp"

namespace greenloop {
namespace {

// the first column whose row is computed
std::uint32_t first_computed(const PartialCapacitance& partial) { return partial.set.count - partial.computed; }

// rows 2 p and 2 p + 1 of sums, by slots
template <unsigned N>
BlockPair<N>* sum_pair(const CapacitanceScratch<N>& scratch, const PartialCapacitance& partial, std::uint32_t p) {
  return scratch.sum + std::size_t{p} * partial.slots;
}

template <unsigned N>
Block<N>& sum_at(const CapacitanceScratch<N>& scratch, const PartialCapacitance& partial, std::uint32_t t,
                 std::uint32_t slot) {
  return sum_pair(scratch, partial, t / 2)[slot].row[t % 2];
}

// displacements of coefficients 2 p and 2 p + 1 per force on those of the computed rows
template <unsigned N>
BlockPair<N>* panel_pair(const CapacitanceScratch<N>& scratch, const PartialCapacitance& partial, std::uint32_t p) {
  return sum_pair(scratch, partial, (partial.computed + 1) / 2) + std::size_t{p} * partial.own;
}

template <unsigned N>
Block<N>& panel_at(const CapacitanceScratch<N>& scratch, const PartialCapacitance& partial, std::uint32_t slot,
                   std::uint32_t own) {
  return panel_pair(scratch, partial, slot / 2)[own].row[slot % 2];
}

// gives the touched coefficients that have none slots from `slots` on; returns the number of slots
template <unsigned N>
std::uint32_t assign_slots(const ModelView& view, const Touched& touched, std::uint32_t slots,
                           CapacitanceScratch<N>& scratch) {
  for (std::uint32_t q = 0; q <= touched.finest; ++q) {
    const LevelView& level = view.level[q];
    for (std::uint32_t k = 0; k < touched.count[q]; ++k) {
      const std::uint32_t coefficient = touched.list[q][k];
      if (scratch.slot[coefficient] == layout::none) {
        scratch.slot[coefficient] = slots;
        scratch.coefficient[slots] = coefficient;
        scratch.root[slots++] = symmetric_block(level.scales_of<N>()[coefficient - level.domain_begin].root);
      }
    }
  }
  return slots;
}

// gives the coarser ones of some columns slots from `slots` on, and finds where the values of all come to stand;
// returns the number of slots
template <unsigned N>
std::uint32_t assign_answers(const PartialCapacitance& partial, std::uint32_t first, std::uint32_t end,
                             std::uint32_t finest, std::uint32_t slots, CapacitanceScratch<N>& scratch) {
  for (std::uint32_t i = first; i < end; ++i) {
    const std::uint32_t column = partial.set.column[i];
    const bool coarser = column_level(column) < finest;
    scratch.answer[i] = coarser ? slots : scratch.slot[column_place(column)];
    if (coarser) {
      scratch.coefficient[slots++] = layout::none;
    }
  }
  return slots;
}

// sums of slot `to` += the weights of slot `from` times a block; returns their number
template <bool blocks, unsigned N>
std::uint32_t add_block(const Block<N>& block, std::uint32_t from, std::uint32_t to,
                        const CapacitanceScratch<N>& scratch) {
  const Functionals<N>& functionals = scratch.functionals;
  const std::uint32_t begin = functionals.slot_begin[from];
  const std::uint32_t end = functionals.slot_begin[from + 1];
  auto* sums = reinterpret_cast<Block<N>*>(scratch.sum + to);
  if constexpr (blocks) {
    add_by_blocks<N>(functionals, from, block, sums);
  } else {
    for (std::uint32_t k = begin; k < end; ++k) {
      const SlotRow at = functionals.row[k];
      add(at.weight, block, sums[at.first]);
    }
  }
  return end - begin;
}

template <unsigned N>
void set_diagonal(const Refinement& refinement, const PartialCapacitance& partial, CapacitanceScratch<N>& scratch) {
  for (std::uint32_t s = 0; s < partial.own; ++s) {
    const std::uint32_t coefficient = scratch.coefficient[s];
    if (coefficient == layout::none) {
      continue;
    }
    const LevelView& level = refinement.view->level[refinement.level[coefficient]];
    const Block<N> scale = symmetric_block(level.scales_of<N>()[coefficient - level.domain_begin].diagonal);
    const Block<N> diagonal = product(scratch.root[s], product(scale, scratch.root[s]));
    if (partial.panel) {
      panel_at(scratch, partial, s, s) = transposed(diagonal);
    } else if (refinement.prediction.blocks) {
      add_block<true>(diagonal, s, s, scratch);
    } else {
      add_block<false>(diagonal, s, s, scratch);
    }
  }
}

// work units of set_diagonal
template <unsigned N>
std::uint64_t diagonal_work(const Refinement& refinement, const PartialCapacitance& partial,
                            const CapacitanceScratch<N>& scratch) {
  const Prices& prices = *scratch.prices;
  const std::uint64_t meetings = partial.panel ? 0 : scratch.functionals.slot_begin[partial.own];
  return priced(partial.own, prices.diagonal) + priced(meetings, meeting_price(prices, refinement.prediction));
}

// blocks of the column of a slot, scaled on both sides
template <unsigned N>
struct LoadedColumn {
  std::uint32_t slot;
  std::uint32_t count;
  Block<N> root;  // of the slot, times the layer's factor
};

template <unsigned N>
Block<N> loaded_block(const LoadedColumn<N>& column, std::uint32_t n, const CapacitanceScratch<N>& scratch) {
  return product(scratch.root[scratch.places[n].target], product(scratch.blocks[n], column.root));
}

// in both directions; returns the number of sums
template <bool blocks, unsigned N>
std::uint64_t add_to_sums(const LoadedColumn<N>& column, const CapacitanceScratch<N>& scratch) {
  std::uint64_t added = 0;
  for (std::uint32_t n = 0; n < column.count; ++n) {
    const std::uint32_t row = scratch.places[n].target;
    const Block<N> block = loaded_block(column, n, scratch);
    added += add_block<blocks>(block, row, column.slot, scratch);
    added += add_block<blocks>(transposed(block), column.slot, row, scratch);
  }
  return added;
}

// in both directions
template <unsigned N>
void add_to_panel(const PartialCapacitance& partial, const LoadedColumn<N>& column,
                  const CapacitanceScratch<N>& scratch) {
  BlockPair<N>* const panel = panel_pair(scratch, partial, 0);
  const std::size_t own = partial.own;
  BlockPair<N>* const of_slot = panel + column.slot / 2 * own;
  for (std::uint32_t n = 0; n < column.count; ++n) {
    const std::uint32_t row = scratch.places[n].target;
    const Block<N> block = loaded_block(column, n, scratch);
    if (row < own) {
      add(transposed(block), of_slot[row].row[column.slot % 2]);
    }
    if (column.slot < own) {
      add(block, panel[row / 2 * own + column.slot].row[row % 2]);
    }
  }
}

// every block that a layer stores in the column of a slot and in a row with one, if the computed rows have either; in
// both directions; returns the work units
template <unsigned N>
std::uint64_t add_couplings(const Refinement& refinement, const PartialCapacitance& partial,
                            CapacitanceScratch<N>& scratch) {
  const std::uint32_t slot = partial.next;
  const std::uint32_t coefficient = scratch.coefficient[slot];
  const LevelView& level = refinement.view->level[refinement.level[coefficient]];
  const CouplingsView& couplings = level.couplings[partial.layer];
  const std::uint32_t column = coefficient - level.domain_begin;
  LoadedColumn<N> loaded;
  loaded.slot = slot;
  loaded.count = load_slotted(couplings, partial.layer, column, scratch.slot,
                              slot < partial.own ? partial.slots : partial.own, scratch.places, scratch.blocks);
  loaded.root = scaled(block_factor<N>(*refinement.view->info, partial.layer), scratch.root[slot]);
  std::uint64_t added = 0;
  if (partial.panel) {
    add_to_panel(partial, loaded, scratch);
  } else {
    added = refinement.prediction.blocks ? add_to_sums<true>(loaded, scratch) : add_to_sums<false>(loaded, scratch);
  }
  const Prices& prices = *scratch.prices;
  return priced(1, prices.layer) + priced(column_length(couplings, column), prices.stored_block) +
         priced(loaded.count, prices.scaled_block) + priced(added, meeting_price(prices, refinement.prediction));
}

// bound of what add_couplings returns
template <unsigned N>
std::uint64_t most_couplings_work(const Refinement& refinement, const PartialCapacitance& partial,
                                  const CapacitanceScratch<N>& scratch) {
  const std::uint32_t coefficient = scratch.coefficient[partial.next];
  const LevelView& level = refinement.view->level[refinement.level[coefficient]];
  const std::uint64_t length = column_length(level.couplings[partial.layer], coefficient - level.domain_begin);
  const Prices& prices = *scratch.prices;
  const std::uint64_t meetings = partial.panel ? 0 : 2 * length * partial.computed;
  return priced(1, prices.layer) + priced(length, prices.stored_block + prices.scaled_block) +
         priced(meetings, meeting_price(prices, refinement.prediction));
}

// the couplings of two coefficients with those of the computed rows become sums of these
template <unsigned N>
void transform_panel(const PartialCapacitance& partial, std::uint32_t pair, CapacitanceScratch<N>& scratch) {
  BlockPair<N>* x = panel_pair(scratch, partial, pair);
  scratch.invert_pair(scratch.inverse, scratch.inverse.steps, x);
  for (std::uint32_t t = 0; t < partial.computed; ++t) {
    const BlockPair<N>& own = x[scratch.answer[first_computed(partial) + t]];
    for (std::uint32_t s = 2 * pair; s < partial.slots && s < 2 * pair + 2; ++s) {
      sum_at(scratch, partial, t, s) = transposed(own.row[s % 2]);
    }
  }
}

// two rows of sums become rows of the matrix, up to the diagonal
template <unsigned N>
void transform_sums(const PartialCapacitance& partial, std::uint32_t pair, CapacitanceScratch<N>& scratch) {
  const std::uint32_t end = first_computed(partial) + 2 * pair + 2;
  std::uint32_t steps = 0;
  for (std::uint32_t i = 0; i < partial.set.count && i < end; ++i) {
    const std::uint32_t settled = scratch.inverse.settled[scratch.answer[i]];
    steps = settled > steps ? settled : steps;
  }
  scratch.invert_pair(scratch.inverse, steps, sum_pair(scratch, partial, pair));
}

// calls visit(i, block (t, i)) of the matrix for the columns up to the diagonal
template <unsigned N, class Visit>
void visit_row(const CapacitanceScratch<N>& scratch, const PartialCapacitance& partial, std::uint32_t t, Visit visit) {
  for (std::uint32_t i = 0; i <= first_computed(partial) + t; ++i) {
    visit(i, sum_at(scratch, partial, t, scratch.answer[i]));
  }
}

// N rows or columns of a matrix, `stride` floats apart, each with N entries
template <unsigned N>
void store(const Block<N>& block, std::size_t stride, float* a) {
  for (std::size_t c = 0; c < N; ++c) {
    std::memcpy(a + c * stride, &block.column[c], N * sizeof(float));
  }
}

}  // namespace

template <unsigned N>
void CapacitanceScratch<N>::carve(Arena& arena, const ModelView& view, const CapacitanceSizes& sizes,
                                  const Prediction& prediction) noexcept {
  touched.carve(arena, view);
  room = capacitance_room(sizes.slots, sizes.columns);
  sorted = arena.take<std::uint32_t>(sizes.columns);
  sorting = arena.take<std::uint32_t>(sizes.columns);
  answer = arena.take<std::uint32_t>(sizes.columns);
  functionals.carve(arena, sizes.columns, sizes.entries, sizes.slots, prediction);
  slot = arena.take<std::uint32_t>(view.domain_count);
  coefficient = arena.take<std::uint32_t>(sizes.slots);
  root = arena.take<Block<N>>(sizes.slots);
  inverse.carve(arena, sizes.slots, prediction);
  invert_pair = fastest_invert_pair<N>();
  sum = arena.take<BlockPair<N>>(room);
  places = arena.take<BlockPlace>(sizes.longest_column + std::uint64_t{1});
  blocks = arena.take<Block<N>>(sizes.longest_column + std::uint64_t{1});
}

template <unsigned N>
std::uint64_t assemble_capacitance(const Refinement& refinement, const ColumnSet& set, const Touched& touched,
                                   CapacitanceScratch<N>& scratch, Vector<N>* force, std::uint32_t stride,
                                   Float4* a) noexcept {
  const std::uint32_t slots = count_slots(set, touched);
  const bool panel = has_panel(scratch.room, slots, set.count);
  const std::uint64_t width = panel ? set.count : batch_width(scratch.room, slots);
  std::uint64_t work = 0;
  for (std::uint32_t first = 0; first < set.count;) {
    PartialCapacitance batch;
    batch.panel = panel;
    batch.computed = static_cast<std::uint32_t>(set.count - first < width ? set.count - first : width);
    batch.set = {first + batch.computed, set.column};
    begin_capacitance(refinement, touched, scratch, force, batch);
    work += add_capacitance_blocks(refinement, touched, scratch, ~std::uint64_t{0}, batch);
    for (std::uint32_t t = 0; t < batch.computed; ++t) {
      float* rows = reinterpret_cast<float*>(a) + std::size_t{N} * (first + t);
      visit_row(scratch, batch, t, [&](std::uint32_t i, const Block<N>& block) {
        store(block, stride, rows + std::size_t{N} * i * stride);
      });
    }
    release_capacitance(batch, scratch);
    first += batch.computed;
  }
  return work;
}

namespace {

// touches what the computed rows reach
template <unsigned N>
void touch_computed(const Refinement& refinement, const PartialCapacitance& partial, CapacitanceScratch<N>& scratch) {
  std::memcpy(scratch.sorted, partial.set.column + first_computed(partial), sizeof(std::uint32_t) * partial.computed);
  merge_sort(partial.computed, scratch.sorted, scratch.sorting, [](std::uint32_t a, std::uint32_t b) { return a < b; });
  touch(refinement, scratch.sorted, partial.computed, scratch.touched);
}

// the steps of T^-1 for what the columns from `first` on touch; values of coarser columns are copied between levels
template <unsigned N>
void list_steps(const Refinement& refinement, const PartialCapacitance& partial, std::uint32_t first,
                const Touched& touched, CapacitanceScratch<N>& scratch) {
  const InverseAnswers answers{partial.set.count - first, partial.set.column + first, scratch.answer + first};
  list_inverse(refinement, touched, scratch.slot, answers, scratch.inverse);
}

}  // namespace

template <unsigned N>
void begin_capacitance(const Refinement& refinement, const Touched& touched, CapacitanceScratch<N>& scratch,
                       Vector<N>* force, PartialCapacitance& partial) noexcept {
  touch_computed(refinement, partial, scratch);
  const std::uint32_t first = first_computed(partial);
  const std::uint32_t finest = touched.finest;
  partial.own = assign_slots(*refinement.view, scratch.touched, 0, scratch);
  partial.own = assign_answers(partial, first, partial.set.count, finest, partial.own, scratch);
  partial.slots = assign_slots(*refinement.view, touched, partial.own, scratch);
  partial.slots = assign_answers(partial, 0, first, finest, partial.slots, scratch);
  partial.own_visits = scratch.touched.visits;
  partial.layer = partial.next = partial.transformed = 0;
  partial.has_diagonal = false;
  if (partial.panel) {
    list_steps(refinement, partial, first, scratch.touched, scratch);
  } else {
    list_steps(refinement, partial, 0, touched, scratch);
  }
  clear(scratch.touched);
  if (partial.panel) {
    std::memset(panel_pair(scratch, partial, 0), 0, sizeof(BlockPair<N>) * pairs(partial.slots) * partial.own);
    if (partial.computed % 2 == 1) {
      std::memset(sum_pair(scratch, partial, partial.computed / 2), 0, sizeof(BlockPair<N>) * partial.slots);
    }
  } else {
    std::memset(scratch.sum, 0, sizeof(BlockPair<N>) * pairs(partial.computed) * partial.slots);
    const SlottedColumns computed{partial.computed, partial.set.column + first, partial.slots, scratch.slot};
    list_functionals<N>(refinement, computed, scratch.touched, force, scratch.functionals);
  }
}

template <unsigned N>
std::uint64_t add_capacitance_blocks(const Refinement& refinement, const Touched& touched,
                                     CapacitanceScratch<N>& scratch, std::uint64_t allowance,
                                     PartialCapacitance& partial) noexcept {
  std::uint64_t work = 0;
  while (partial.next < partial.slots) {
    const bool has_blocks = scratch.coefficient[partial.next] != layout::none;
    if (has_blocks && most_couplings_work(refinement, partial, scratch) > allowance - work) {
      return work;
    }
    work += has_blocks ? add_couplings(refinement, partial, scratch) : 0;
    partial.layer = (partial.layer + 1) % layout::layers;
    partial.next += partial.layer == 0 ? 1 : 0;
  }
  if (!partial.has_diagonal) {  // the largest last
    const std::uint64_t diagonal = diagonal_work(refinement, partial, scratch);
    if (diagonal > allowance - work) {
      return work;
    }
    set_diagonal(refinement, partial, scratch);
    partial.has_diagonal = true;
    work += diagonal;
  }
  for (const std::uint32_t panel = partial.panel_pairs(); partial.has_blocks_left(); ++partial.transformed) {
    const bool in_panel = partial.transformed < panel;
    const bool lists = partial.transformed + 1 == panel && partial.computed < partial.set.count;
    const std::uint64_t pair =
        (in_panel ? panel_pair_work(*scratch.prices, refinement.prediction, partial.own_visits, partial.computed)
                  : sum_pair_work(*scratch.prices, refinement.prediction, touched.visits)) +
        (lists ? list_set_work(*scratch.prices, touched.visits) : 0);
    if (pair > allowance - work) {
      return work;
    }
    work += pair;
    if (in_panel) {
      transform_panel(partial, partial.transformed, scratch);
    } else {
      transform_sums(partial, partial.transformed - panel, scratch);
    }
    if (lists) {
      list_steps(refinement, partial, 0, touched, scratch);
    }
  }
  return work;
}

template <unsigned N>
void store_capacitance_row(const CapacitanceScratch<N>& scratch, const PartialCapacitance& partial, std::uint32_t t,
                           std::uint32_t stride, Float4* row) noexcept {
  visit_row(scratch, partial, t, [&](std::uint32_t i, const Block<N>& block) {
    store(transposed(block), stride, reinterpret_cast<float*>(row) + std::size_t{N} * i);
  });
}

template <unsigned N>
void release_capacitance(const PartialCapacitance& partial, CapacitanceScratch<N>& scratch) noexcept {
  for (std::uint32_t s = 0; s < partial.slots; ++s) {
    if (scratch.coefficient[s] != layout::none) {
      scratch.slot[scratch.coefficient[s]] = layout::none;
    }
  }
}

template struct CapacitanceScratch<1>;
template struct CapacitanceScratch<3>;
template std::uint64_t assemble_capacitance<1>(const Refinement&, const ColumnSet&, const Touched&,
                                               CapacitanceScratch<1>&, Vector<1>*, std::uint32_t, Float4*) noexcept;
template void begin_capacitance<1>(const Refinement&, const Touched&, CapacitanceScratch<1>&, Vector<1>*,
                                   PartialCapacitance&) noexcept;
template std::uint64_t add_capacitance_blocks<1>(const Refinement&, const Touched&, CapacitanceScratch<1>&,
                                                 std::uint64_t, PartialCapacitance&) noexcept;
template void store_capacitance_row<1>(const CapacitanceScratch<1>&, const PartialCapacitance&, std::uint32_t,
                                       std::uint32_t, Float4*) noexcept;
template void release_capacitance<1>(const PartialCapacitance&, CapacitanceScratch<1>&) noexcept;
template std::uint64_t assemble_capacitance<3>(const Refinement&, const ColumnSet&, const Touched&,
                                               CapacitanceScratch<3>&, Vector<3>*, std::uint32_t, Float4*) noexcept;
template void begin_capacitance<3>(const Refinement&, const Touched&, CapacitanceScratch<3>&, Vector<3>*,
                                   PartialCapacitance&) noexcept;
template std::uint64_t add_capacitance_blocks<3>(const Refinement&, const Touched&, CapacitanceScratch<3>&,
                                                 std::uint64_t, PartialCapacitance&) noexcept;
template void store_capacitance_row<3>(const CapacitanceScratch<3>&, const PartialCapacitance&, std::uint32_t,
                                       std::uint32_t, Float4*) noexcept;
template void release_capacitance<3>(const PartialCapacitance&, CapacitanceScratch<3>&) noexcept;

}  // namespace greenloop
