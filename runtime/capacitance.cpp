#include "runtime/capacitance.hpp"

#include <cstddef>
#include <cstring>

#include "runtime/cholesky.hpp"
#include "runtime/column.hpp"

namespace greenloop {
namespace {

Block scaled(Float4 factor, const Block& block) {
  return {{factor * block.column[0], factor * block.column[1], factor * block.column[2]}};
}

// gives every coefficient that the set touches a slot; returns their number
std::uint32_t assign_slots(const ModelView& view, const Touched& touched, CapacitanceScratch& scratch) {
  std::uint32_t slots = 0;
  for (std::uint32_t q = 0; q <= touched.finest; ++q) {
    const LevelView& level = view.level[q];
    for (std::uint32_t k = 0; k < touched.count[q]; ++k) {
      const std::uint32_t coefficient = touched.list[q][k];
      scratch.slot[coefficient] = slots;
      scratch.root[slots++] = symmetric_block(level.scales[coefficient - level.domain_begin].root);
    }
  }
  return slots;
}

void release_slots(const Touched& touched, CapacitanceScratch& scratch) {
  for (std::uint32_t q = 0; q <= touched.finest; ++q) {
    for (std::uint32_t k = 0; k < touched.count[q]; ++k) {
      scratch.slot[touched.list[q][k]] = layout::none;
    }
  }
}

// the functional of a column, from `begin`; returns its end
std::uint32_t write_functional(const Refinement& refinement, std::uint32_t column, std::uint32_t begin,
                               CapacitanceScratch& scratch, Float4* force) {
  Touched& touched = scratch.touched;
  touch(refinement, &column, 1, touched);
  force[column_place(column)] = splat3(1.0F);
  transform_forces(refinement, touched, force);
  std::uint32_t end = begin;
  for (std::uint32_t q = 0; q <= touched.finest; ++q) {
    for (std::uint32_t k = 0; k < touched.count[q]; ++k) {
      const std::uint32_t coefficient = touched.list[q][k];
      scratch.coefficients[end++] = {scratch.slot[coefficient], force[coefficient][0]};
    }
  }
  clear_forces(touched, force);
  clear(touched);
  return end;
}

// the functionals' weights by slots
void list_slot_columns(std::uint32_t columns, std::uint32_t slots, CapacitanceScratch& scratch) {
  std::uint32_t* begin = scratch.slot_begin;
  std::memset(begin, 0, sizeof(std::uint32_t) * (slots + std::size_t{1}));
  for (std::uint32_t k = 0; k < scratch.begin[columns]; ++k) {
    ++begin[scratch.coefficients[k].slot];
  }
  std::uint32_t end = 0;
  for (std::uint32_t s = 0; s < slots; ++s) {
    const std::uint32_t count = begin[s];
    begin[s] = scratch.batch_end[s] = end;
    end += count;
  }
  begin[slots] = end;
  for (std::uint32_t i = 0; i < columns; ++i) {
    for (std::uint32_t k = scratch.begin[i]; k < scratch.begin[i + 1]; ++k) {
      const PointCoefficient& at = scratch.coefficients[k];
      scratch.column[scratch.batch_end[at.slot]++] = {i, at.weight};
    }
  }
  for (std::uint32_t s = 0; s < slots; ++s) {
    scratch.batch_end[s] = begin[s];
  }
}

// some columns of the matrix, and the sums of their slots
struct Batch {
  std::uint32_t first;
  std::uint32_t count;
};

void begin_batch(const Batch& batch, std::uint32_t slots, CapacitanceScratch& scratch) {
  for (std::uint32_t s = 0; s < slots; ++s) {
    std::uint32_t end = scratch.batch_end[s];
    scratch.batch_begin[s] = end;
    while (end < scratch.slot_begin[s + 1] && scratch.column[end].column < batch.first + batch.count) {
      ++end;
    }
    scratch.batch_end[s] = end;
  }
  std::memset(scratch.sum, 0, sizeof(Block) * slots * batch.count);
}

// sums of slot `to` += a block times the unit forces in slot `from`, in the columns that some row at or below the
// diagonal asks slot `to` for; returns their number
std::uint32_t add_block(const Batch& batch, const Block& block, std::uint32_t from, std::uint32_t to,
                        CapacitanceScratch& scratch) {
  const std::uint32_t last = scratch.column[scratch.slot_begin[to + 1] - 1].column;
  Block* sums = scratch.sum + std::size_t{to} * batch.count;
  std::uint32_t added = 0;
  for (std::uint32_t k = scratch.batch_begin[from]; k < scratch.batch_end[from]; ++k) {
    const SlotColumn at = scratch.column[k];
    if (at.column > last) {
      break;
    }
    Block& sum = sums[at.column - batch.first];
    const Float4 weight = splat(at.weight);
    sum.column[0] += weight * block.column[0];
    sum.column[1] += weight * block.column[1];
    sum.column[2] += weight * block.column[2];
    ++added;
  }
  return added;
}

void add_diagonal(const LevelView& level, const std::uint32_t* list, std::uint32_t count, const Batch& batch,
                  CapacitanceScratch& scratch) {
  for (std::uint32_t k = 0; k < count; ++k) {
    const std::uint32_t slot = scratch.slot[list[k]];
    const Block diagonal = symmetric_block(level.scales[list[k] - level.domain_begin].diagonal);
    add_block(batch, product(scratch.root[slot], product(diagonal, scratch.root[slot])), slot, slot, scratch);
  }
}

// every block that a layer stores in a column and a row with a slot, in both directions; returns the work units
std::uint64_t add_couplings(const LevelView& level, std::uint32_t layer, float factor, std::uint32_t coefficient,
                            const Batch& batch, CapacitanceScratch& scratch) {
  const std::uint32_t slot = scratch.slot[coefficient];
  const std::uint32_t column = coefficient - level.domain_begin;
  const std::uint32_t blocks =
      load_slotted(level.couplings[layer], layer, column, scratch.slot, scratch.places, scratch.blocks);
  const Block root = scaled(splat(factor), scratch.root[slot]);
  std::uint64_t added = 0;
  for (std::uint32_t n = 0; n < blocks; ++n) {
    const std::uint32_t row = scratch.places[n].target;
    const Block block = product(scratch.root[row], product(scratch.blocks[n], root));
    added += add_block(batch, block, slot, row, scratch);
    added += add_block(batch, transposed(block), row, slot, scratch);
  }
  return 20 * std::uint64_t{column_length(level.couplings[layer], column)} + 54 * std::uint64_t{blocks} + 9 * added;
}

// bound of what add_couplings returns
std::uint64_t most_couplings_work(const LevelView& level, std::uint32_t layer, std::uint32_t coefficient,
                                  const Batch& batch, const CapacitanceScratch& scratch) {
  const std::uint32_t slot = scratch.slot[coefficient];
  const std::uint64_t sums = scratch.batch_end[slot] - scratch.batch_begin[slot] + std::uint64_t{batch.count};
  return column_length(level.couplings[layer], coefficient - level.domain_begin) * (74 + 9 * sums);
}

Block apply(const CapacitanceScratch& scratch, const Batch& batch, std::uint32_t i, std::uint32_t j) {
  Block sum{};
  for (std::uint32_t k = scratch.begin[i]; k < scratch.begin[i + 1]; ++k) {
    const PointCoefficient& at = scratch.coefficients[k];
    const Block& block = scratch.sum[std::size_t{at.slot} * batch.count + (j - batch.first)];
    const Float4 weight = splat(at.weight);
    sum.column[0] += weight * block.column[0];
    sum.column[1] += weight * block.column[1];
    sum.column[2] += weight * block.column[2];
  }
  return sum;
}

// a: top left entry of a 3x3 block in a matrix by columns
void store(const Block& block, std::size_t stride, float* a) {
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t r = 0; r < 3; ++r) {
      a[c * stride + r] = block.column[c][r];
    }
  }
}

// slots, functionals and their columns by slots; returns the number of slots
std::uint32_t list_functionals(const Refinement& refinement, const CapacitanceColumns& set, const Touched& touched,
                               CapacitanceScratch& scratch, Float4* force) {
  const std::uint32_t slots = assign_slots(*refinement.view, touched, scratch);
  scratch.begin[0] = 0;
  for (std::uint32_t i = 0; i < set.count; ++i) {
    scratch.begin[i + 1] = write_functional(refinement, set.column[i], scratch.begin[i], scratch, force);
  }
  list_slot_columns(set.count, slots, scratch);
  return slots;
}

void store_column(const CapacitanceScratch& scratch, const Batch& batch, std::uint32_t columns, std::uint32_t j,
                  std::uint32_t stride, float* column) {
  for (std::uint32_t i = j; i < columns; ++i) {
    store(apply(scratch, batch, i, j), stride, column + std::size_t{3} * i);
  }
}

}  // namespace

void add_degrees(const ModelView& view, std::uint32_t q, std::uint32_t* degree) noexcept {
  const LevelView& level = view.level[q];
  for (const CouplingsView& couplings : level.couplings) {
    for (std::uint32_t j = 0; j < couplings.columns; ++j) {
      const std::uint32_t column = level.domain_begin + j;
      degree[column] += column_length(couplings, j);
      visit_rows(couplings, j, 0, column, [degree](std::uint32_t row, std::uint32_t) { ++degree[row]; });
    }
  }
}

ColumnCost column_cost(const Refinement& refinement, std::uint32_t column, const std::uint32_t* degree,
                       Touched& touched) noexcept {
  touch(refinement, &column, 1, touched);
  ColumnCost cost;
  cost.visits = static_cast<std::uint32_t>(touched.visits);
  for (std::uint32_t q = 0; q <= touched.finest; ++q) {
    cost.coefficients += touched.count[q];
    for (std::uint32_t k = 0; k < touched.count[q]; ++k) {
      cost.blocks += degree[touched.list[q][k]];
    }
  }
  clear(touched);
  return cost;
}

void assemble_capacitance(const Refinement& refinement, const CapacitanceColumns& set, const Touched& touched,
                          CapacitanceScratch& scratch, Float4* force, std::uint32_t stride, Float4* a) noexcept {
  const ModelView& view = *refinement.view;
  const std::uint32_t slots = list_functionals(refinement, set, touched, scratch, force);
  const std::uint64_t width = batch_width(scratch.room, slots);
  for (Batch batch{0, 0}; batch.first < set.count; batch.first += batch.count) {
    const std::uint32_t left = set.count - batch.first;
    batch.count = left < width ? left : static_cast<std::uint32_t>(width);
    begin_batch(batch, slots, scratch);
    for (std::uint32_t q = 0; q <= touched.finest; ++q) {
      const LevelView& level = view.level[q];
      add_diagonal(level, touched.list[q], touched.count[q], batch, scratch);
      for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
        const float factor = block_factor(*view.info, layer);
        for (std::uint32_t k = 0; k < touched.count[q]; ++k) {
          add_couplings(level, layer, factor, touched.list[q][k], batch, scratch);
        }
      }
    }
    for (std::uint32_t j = batch.first; j < batch.first + batch.count; ++j) {
      store_column(scratch, batch, set.count, j, stride, reinterpret_cast<float*>(a) + std::size_t{3} * j * stride);
    }
  }
  release_slots(touched, scratch);
}

void begin_capacitance(const Refinement& refinement, const Touched& touched, CapacitanceScratch& scratch, Float4* force,
                       PartialCapacitance& partial) noexcept {
  const Batch batch{0, partial.computed};
  begin_batch(batch, list_functionals(refinement, partial.set, touched, scratch, force), scratch);
  for (std::uint32_t q = 0; q <= touched.finest; ++q) {
    add_diagonal(refinement.view->level[q], touched.list[q], touched.count[q], batch, scratch);
  }
  partial.finest = touched.finest;
  partial.level = partial.layer = partial.next = 0;
}

std::uint64_t add_capacitance_blocks(const ModelView& view, const Touched& touched, CapacitanceScratch& scratch,
                                     std::uint64_t allowance, PartialCapacitance& partial) noexcept {
  const Batch batch{0, partial.computed};
  std::uint64_t work = 0;
  while (partial.has_blocks_left()) {
    const LevelView& level = view.level[partial.level];
    const float factor = block_factor(*view.info, partial.layer);
    for (; partial.next < touched.count[partial.level]; ++partial.next) {
      const std::uint32_t coefficient = touched.list[partial.level][partial.next];
      if (most_couplings_work(level, partial.layer, coefficient, batch, scratch) > allowance - work) {
        return work;
      }
      work += add_couplings(level, partial.layer, factor, coefficient, batch, scratch);
    }
    partial.next = 0;
    partial.layer = (partial.layer + 1) % layout::layers;
    partial.level += partial.layer == 0 ? 1 : 0;
  }
  return work;
}

void store_capacitance_column(const CapacitanceScratch& scratch, const PartialCapacitance& partial, std::uint32_t j,
                              std::uint32_t stride, Float4* column) noexcept {
  store_column(scratch, {0, partial.computed}, partial.set.count, j, stride, reinterpret_cast<float*>(column));
}

void release_capacitance(const Touched& touched, CapacitanceScratch& scratch) noexcept {
  release_slots(touched, scratch);
}

}  // namespace greenloop
