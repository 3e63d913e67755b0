#pragma once

#include <cstdint>

#include "runtime/compliance/couplings.hpp"
#include "runtime/compliance/functionals.hpp"
#include "runtime/memory/arena.hpp"
#include "runtime/wavelet/column.hpp"
#include "runtime/wavelet/reach.hpp"
#include "runtime/wavelet/refinement.hpp"
#include "runtime/wavelet/sparse_inverse.hpp"

namespace greenloop {

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

/// What two rows of a matrix have in the same column.
struct BlockPair {
  Block row[2];
};

constexpr std::uint64_t pairs(std::uint64_t rows) { return (rows + 1) / 2; }

/// Memory of assemble_capacitance. A coefficient of the set's functionals has a slot, and so has each coarser column of
/// a mixed set, for the value that its node has on its own level; there are `columns` columns and `entries` weights of
/// functionals.
struct CapacitanceScratch {
  static constexpr std::uint32_t batch = 16;  ///< rows of the matrix that are summed together, at least; even

  Touched touched;                       ///< by the rows that are computed, or by one column
  std::uint32_t* sorted = nullptr;       ///< [columns] those rows
  std::uint32_t* sorting = nullptr;      ///< [columns] scratch
  std::uint32_t* answer = nullptr;       ///< [columns] slot that holds each column's value in the end
  Functionals functionals;               ///< of the rows that are computed; `entries` weights
  std::uint32_t* slot = nullptr;         ///< [domain], layout::none between calls
  std::uint32_t* coefficient = nullptr;  ///< [slots] its place; layout::none: that of a column
  Block* root = nullptr;                 ///< [slots] scale
  SparseInverse inverse;                 ///< of the slots
  std::uint64_t room = 0;                ///< pairs: slots * pairs(min(columns, batch)) of the most there may be
  BlockPair* sum = nullptr;              ///< [room]
  BlockPlace* places = nullptr;          ///< [longest column + 1]
  Block* blocks = nullptr;               ///< [longest column + 1]
};

/// Adds the blocks, of all layers, that level q stores to the counts of both of their coefficients. degree: [domain of
/// K(q)]. Start-up.
void add_degrees(const ModelView& view, std::uint32_t q, std::uint32_t* degree) noexcept;

/// What a column of level c costs. degree: by levels 0..c, as add_degrees counts. Start-up.
[[nodiscard]] ColumnCost column_cost(const Refinement& refinement, std::uint32_t column, const std::uint32_t* degree,
                                     Touched& touched) noexcept;

/// What the work of assemble_capacitance follows from.
struct CapacitanceCounts {
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
  return width > CapacitanceScratch::batch ? width : CapacitanceScratch::batch;
}

/// Whether the scratch holds the couplings of all slots beside the sums of the rows that are computed.
constexpr bool has_panel(std::uint64_t room, std::uint64_t slots, std::uint64_t rows) {
  return slots * (pairs(slots) + pairs(rows)) <= room;
}

/// Work units of begin_capacitance.
[[nodiscard]] std::uint64_t begin_capacitance_work(const CapacitanceCounts& counts) noexcept;

/// Bound of the work units of add_capacitance_blocks until no blocks are left.
[[nodiscard]] std::uint64_t add_capacitance_blocks_work(const CapacitanceCounts& counts) noexcept;

/// Work units of store_capacitance_row.
constexpr std::uint64_t store_capacitance_work(std::uint64_t columns) { return 9 * columns; }

/// Work units of assemble_capacitance, or their bound.
[[nodiscard]] std::uint64_t assemble_capacitance_work(const CapacitanceCounts& counts) noexcept;

/// Slots of a set: the coefficients that it touches, and its columns that are coarser than the finest. For the loop;
/// work: a unit a column.
[[nodiscard]] std::uint32_t count_slots(const ColumnSet& set, const Touched& touched) noexcept;

// The capacitance matrix in force form: block (i, j) is the displacement of the average of column i per force at column
// j (James & Pai 2003, sections 3.2 and 5.4), by all layers. It is A = T^-1 S T^-T of the couplings S between the
// touched coefficients. Where the scratch has room for these, T^-1 is applied to each of their rows, step by step;
// otherwise, for many columns or such that share few coefficients, they are summed by functionals, which are rows of
// T^-1. Then T^-1 is applied to each row of sums, step by step. A is symmetric.

/// The lower half of the capacitance matrix. Every block between two touched coefficients is read once, or once per
/// batch of rows. touched: by the set; a: by columns, `stride` floats apart; force: [domain], 0 before and after. For
/// the loop; work: assemble_capacitance_work.
void assemble_capacitance(const Refinement& refinement, const ColumnSet& set, const Touched& touched,
                          CapacitanceScratch& scratch, Float4* force, std::uint32_t stride, Float4* a) noexcept;

// The last rows of the same, in pieces: begin, add the blocks, store the rows, release. Until it is released,
// `scratch` and the touched coefficients belong to it.

struct PartialCapacitance {
  ColumnSet set;               ///< in any order
  std::uint32_t computed = 0;  ///< rows, no more than batch_width
  bool panel = false;          ///< has_panel of the set
  std::uint32_t slots = 0;
  std::uint32_t own = 0;         ///< slots, the first, of the rows that are computed
  std::uint64_t own_visits = 0;  ///< of touching these
  // the coefficient whose blocks are added next
  std::uint32_t layer = 0;
  std::uint32_t next = 0;
  std::uint32_t transformed = 0;  ///< pairs of rows, of the panel and then of the sums

  [[nodiscard]] std::uint32_t panel_pairs() const noexcept {
    return panel ? static_cast<std::uint32_t>(pairs(slots)) : 0;
  }
  [[nodiscard]] bool has_blocks_left() const noexcept {
    return next < slots || transformed < panel_pairs() + pairs(computed);
  }
};

/// Finds the slots and the steps of T^-1 or the functionals. partial: its set, number of rows and panel. For the loop;
/// work: begin_capacitance_work, which holds that of the diagonal, to be added after the blocks.
void begin_capacitance(const Refinement& refinement, const Touched& touched, CapacitanceScratch& scratch, Float4* force,
                       PartialCapacitance& partial) noexcept;

/// Adds the blocks of as many coefficients as `allowance` holds, at 4 units for each that is stored, 84 for each that
/// is between touched coefficients and, by functionals, Prediction::weight_work for each sum that one adds to; then
/// transforms the couplings of two coefficients at a time, for Prediction::pair_work for each visit that touching the
/// computed rows takes and 6 for each of these, and two of these at a time, for pair_work for each visit that the set
/// takes. Returns the units spent. For the loop.
std::uint64_t add_capacitance_blocks(const Refinement& refinement, const Touched& touched, CapacitanceScratch& scratch,
                                     std::uint64_t allowance, PartialCapacitance& partial) noexcept;

/// Writes the three rows of the t-th node that is computed, up to the diagonal. row: `stride` floats each. For the
/// loop.
void store_capacitance_row(const CapacitanceScratch& scratch, const PartialCapacitance& partial, std::uint32_t t,
                           std::uint32_t stride, Float4* row) noexcept;

/// Gives the scratch free. For the loop; work: within begin_capacitance's.
void release_capacitance(const PartialCapacitance& partial, CapacitanceScratch& scratch) noexcept;

}  // namespace greenloop
