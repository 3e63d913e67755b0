#pragma once

#include <cstdint>

#include "runtime/arena.hpp"
#include "runtime/column.hpp"
#include "runtime/contact_set.hpp"
#include "runtime/couplings.hpp"
#include "runtime/sparse_forces.hpp"

namespace greenloop {

/// A coefficient, by its slot, that a node's displacement depends on, and the weight: together a row of T^-1, which is
/// a column of T^-T.
struct PointCoefficient {
  std::uint32_t slot;
  float weight;
};

/// What a column of the capacitance matrix costs.
struct ColumnCost {
  std::uint32_t coefficients = 0;  ///< of its functional
  std::uint32_t blocks = 0;        ///< stored blocks in the lists of those, over all layers
  std::uint32_t visits = 0;        ///< of touch
};

/// The costs of all columns.
struct ColumnCosts {
  const ColumnCost* level[layout::max_levels] = {};  ///< [c][domain nodes of K(c)]

  [[nodiscard]] const ColumnCost& of(std::uint32_t column) const noexcept {
    return level[column_level(column)][column_place(column)];
  }
};

/// A column that depends on a coefficient, and the weight.
struct SlotColumn {
  std::uint32_t column;
  float weight;
};

/// Memory of assemble_capacitance. A coefficient of the set's functionals has a slot; there are `columns` columns and
/// `entries` weights of functionals.
struct CapacitanceScratch {
  static constexpr std::uint32_t batch = 16;  ///< columns of the matrix that are summed together, at least

  Touched touched;                           ///< of one node at a time
  PointCoefficient* coefficients = nullptr;  ///< [entries] the functionals, one after the other
  std::uint32_t* begin = nullptr;            ///< [columns + 1] of each functional
  SlotColumn* column = nullptr;              ///< [entries] the same by slots
  std::uint32_t* slot_begin = nullptr;       ///< [slots + 1] of each slot
  std::uint32_t* batch_begin = nullptr;      ///< [slots] its columns in the batch
  std::uint32_t* batch_end = nullptr;        ///< [slots]
  std::uint32_t* slot = nullptr;             ///< [domain], layout::none between calls
  Block* root = nullptr;                     ///< [slots] scale
  std::uint64_t room = 0;                    ///< slots * min(columns, batch), of the most there may be
  Block* sum = nullptr;                      ///< [room]
  BlockPlace* places = nullptr;              ///< [longest column + 1]
  Block* blocks = nullptr;                   ///< [longest column + 1]
};

/// Adds the blocks, of all layers, that level q stores to the counts of both of their coefficients. degree: [domain of
/// K(q)]. Start-up.
void add_degrees(const ModelView& view, std::uint32_t q, std::uint32_t* degree) noexcept;

/// What a column of level c costs. degree: by levels 0..c, as add_degrees counts. Start-up.
[[nodiscard]] ColumnCost column_cost(const Refinement& refinement, std::uint32_t column, const std::uint32_t* degree,
                                     Touched& touched) noexcept;

/// What the work of assemble_capacitance follows from.
struct CapacitanceCounts {
  std::uint64_t columns = 0;       ///< that are computed
  std::uint64_t slots = 0;         ///< coefficients that the set touches
  std::uint64_t stored = 0;        ///< blocks in the columns of those in all layers
  std::uint64_t visits = 0;        ///< ColumnCost summed over the columns of the set
  std::uint64_t coefficients = 0;  ///< the same
  std::uint64_t blocks = 0;        ///< ColumnCost summed over the columns that are computed
  std::uint64_t room = 0;          ///< of the scratch
};

/// Columns that are summed together: as many as the scratch has room for. slots: positive.
constexpr std::uint64_t batch_width(std::uint64_t room, std::uint64_t slots) {
  return room / slots > CapacitanceScratch::batch ? room / slots : CapacitanceScratch::batch;
}

/// Work units of assemble_capacitance.
constexpr std::uint64_t assemble_capacitance_work(const CapacitanceCounts& counts) {
  const std::uint64_t width = batch_width(counts.room, counts.slots > 0 ? counts.slots : 1);
  const std::uint64_t batches = (counts.columns + width - 1) / width;
  return 5 * counts.visits + 16 * counts.coefficients + 16 * counts.slots +
         batches * (68 * counts.slots + 74 * counts.stored) + 9 * counts.blocks +
         counts.columns * (3 * counts.slots + 9 * counts.coefficients);
}

/// Rows and columns of a capacitance matrix.
struct CapacitanceColumns {
  std::uint32_t count;
  const std::uint32_t* column;  ///< [count] in any order
};

/// The lower half of the capacitance matrix in force form: block (i, j) is the
/// displacement of the average of column i per force at column j (James & Pai 2003, sections 3.2 and 5.4), by all
/// layers; it is symmetric. Every block between two touched coefficients is read once per batch of columns. touched: by
/// the set; a: by columns, `stride` floats apart; force: [domain], 0 before and after. For the loop; work:
/// assemble_capacitance_work.
void assemble_capacitance(const Refinement& refinement, const CapacitanceColumns& set, const Touched& touched,
                          CapacitanceScratch& scratch, Float4* force, std::uint32_t stride, Float4* a) noexcept;

// The first columns of the same, in pieces: begin, add the blocks, store the columns, release. Until it is released,
// `scratch` and the touched coefficients belong to it.

struct PartialCapacitance {
  CapacitanceColumns set{};
  std::uint32_t computed = 0;  ///< columns, no more than batch_width
  std::uint32_t finest = 0;    ///< level of a coefficient
  // the coefficient whose blocks are added next
  std::uint32_t level = 0;
  std::uint32_t layer = 0;
  std::uint32_t next = 0;

  [[nodiscard]] bool has_blocks_left() const noexcept { return level <= finest; }
};

/// Work units of begin_capacitance.
constexpr std::uint64_t begin_capacitance_work(const CapacitanceCounts& counts) {
  return 5 * counts.visits + 16 * counts.coefficients + 84 * counts.slots;
}

/// Finds the functionals, and adds the diagonal. partial: its set and number of columns. For the loop.
void begin_capacitance(const Refinement& refinement, const Touched& touched, CapacitanceScratch& scratch, Float4* force,
                       PartialCapacitance& partial) noexcept;

/// Adds the blocks of as many coefficients as `allowance` holds at 20 units for each that is stored, 54 for each
/// between two touched coefficients and 9 for each sum that one adds to; returns the units spent. For the loop.
std::uint64_t add_capacitance_blocks(const ModelView& view, const Touched& touched, CapacitanceScratch& scratch,
                                     std::uint64_t allowance, PartialCapacitance& partial) noexcept;

/// Work units of store_capacitance_column.
constexpr std::uint64_t store_capacitance_work(const CapacitanceCounts& counts) {
  return 3 * counts.slots + 9 * counts.coefficients;
}

/// Writes the three columns of j, from the diagonal down. column: `stride` floats each, row 3 i of column i. For the
/// loop.
void store_capacitance_column(const CapacitanceScratch& scratch, const PartialCapacitance& partial, std::uint32_t j,
                              std::uint32_t stride, Float4* column) noexcept;

/// Gives the scratch free. For the loop; work: within begin_capacitance's.
void release_capacitance(const Touched& touched, CapacitanceScratch& scratch) noexcept;

}  // namespace greenloop
