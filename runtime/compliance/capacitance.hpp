#pragma once

#include <cstdint>

#include "runtime/algebra/block.hpp"
#include "runtime/compliance/capacitance_work.hpp"
#include "runtime/compliance/couplings.hpp"
#include "runtime/compliance/functionals.hpp"
#include "runtime/memory/arena.hpp"
#include "runtime/wavelet/column.hpp"
#include "runtime/wavelet/pair_inverse.hpp"
#include "runtime/wavelet/reach.hpp"
#include "runtime/wavelet/refinement.hpp"

namespace greenloop {

/// Bounds over all sets that a CapacitanceScratch has room for.
struct CapacitanceSizes {
  std::uint32_t columns;
  std::uint64_t entries;         ///< weights of functionals
  std::uint64_t slots;           ///< see below
  std::uint32_t longest_column;  ///< blocks in a column of a layer
};

/// Memory of assemble_capacitance. A coefficient of the set's functionals has a slot, and so has each coarser column of
/// a mixed set, for the value that its node has on its own level; there are `columns` columns and `entries` weights of
/// functionals.
template <unsigned N>
struct CapacitanceScratch {
  const Prices* prices = nullptr;        ///< of what it is used for
  Touched touched;                       ///< by the rows that are computed, or by one column
  std::uint32_t* sorted = nullptr;       ///< [columns] those rows
  std::uint32_t* sorting = nullptr;      ///< [columns] scratch
  std::uint32_t* answer = nullptr;       ///< [columns] slot that holds each column's value in the end
  Functionals<N> functionals;            ///< of the rows that are computed; `entries` weights
  std::uint32_t* slot = nullptr;         ///< [domain], layout::none between calls
  std::uint32_t* coefficient = nullptr;  ///< [slots] its place; layout::none: that of a column
  Block<N>* root = nullptr;              ///< [slots] scale
  SparseInverse inverse;                 ///< of the slots
  InvertPair<N> invert_pair = nullptr;   ///< what applies it to two rows
  std::uint64_t room = 0;                ///< capacitance_room of the most there may be
  BlockPair<N>* sum = nullptr;           ///< [room]
  BlockPlace* places = nullptr;          ///< [longest column + 1]
  Block<N>* blocks = nullptr;            ///< [longest column + 1]

  /// Arrays out of `arena`; null while it counts.
  void carve(Arena& arena, const ModelView& view, const CapacitanceSizes& sizes, const Prediction& prediction) noexcept;
};

// The capacitance matrix in force form: block (i, j) is the displacement of the average of column i per force at column
// j (James & Pai 2003, sections 3.2 and 5.4), by all layers. It is A = T^-1 S T^-T of the couplings S between the
// touched coefficients. Where the scratch has room for these, T^-1 is applied to each of their rows, step by step;
// otherwise, for many columns or such that share few coefficients, they are summed by functionals, which are rows of
// T^-1. Then T^-1 is applied to each row of sums, step by step. A is symmetric.

/// The lower half of the capacitance matrix. Every block between two touched coefficients is read once, or once per
/// batch of rows. touched: by the set; a: by columns, `stride` floats apart; force: [domain], 0 before and after.
/// Returns the units that the blocks took, at most assemble_blocks_work. For the loop; work: assemble_capacitance_work.
template <unsigned N>
std::uint64_t assemble_capacitance(const Refinement& refinement, const ColumnSet& set, const Touched& touched,
                                   CapacitanceScratch<N>& scratch, Vector<N>* force, std::uint32_t stride,
                                   Float4* a) noexcept;

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
  bool has_diagonal = false;
  std::uint32_t transformed = 0;  ///< pairs of rows, of the panel and then of the sums

  [[nodiscard]] std::uint32_t panel_pairs() const noexcept {
    return panel ? static_cast<std::uint32_t>(pairs(slots)) : 0;
  }
  [[nodiscard]] bool has_blocks_left() const noexcept {
    return next < slots || transformed < panel_pairs() + pairs(computed);
  }
};

/// Finds the slots and the steps of T^-1 or the functionals. partial: its set, number of rows and panel. For the loop;
/// work: begin_capacitance_work.
template <unsigned N>
void begin_capacitance(const Refinement& refinement, const Touched& touched, CapacitanceScratch<N>& scratch,
                       Vector<N>* force, PartialCapacitance& partial) noexcept;

/// Adds the blocks of as many coefficients as `allowance` holds, at Prices::layer for each layer, stored_block for each
/// block that is stored, scaled_block for each that is between touched coefficients and, by functionals, meeting_price
/// for each sum that one adds to; then the diagonal ones, at Prices::diagonal and the sums' each; then transforms the
/// couplings of two coefficients at a time, for panel_pair_work, after the last list_set_work, and two of the computed
/// rows at a time, for sum_pair_work. Returns the units spent. For the loop.
template <unsigned N>
std::uint64_t add_capacitance_blocks(const Refinement& refinement, const Touched& touched,
                                     CapacitanceScratch<N>& scratch, std::uint64_t allowance,
                                     PartialCapacitance& partial) noexcept;

/// Writes the N rows of the t-th node that is computed, up to the diagonal. row: `stride` floats each. For the
/// loop.
template <unsigned N>
void store_capacitance_row(const CapacitanceScratch<N>& scratch, const PartialCapacitance& partial, std::uint32_t t,
                           std::uint32_t stride, Float4* row) noexcept;

/// Gives the scratch free. For the loop; work: within begin_capacitance's.
template <unsigned N>
void release_capacitance(const PartialCapacitance& partial, CapacitanceScratch<N>& scratch) noexcept;

}  // namespace greenloop
