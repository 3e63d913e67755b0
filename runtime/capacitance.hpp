#pragma once

#include <cstdint>

#include "runtime/arena.hpp"
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

/// What a node costs as a column of the capacitance matrix.
struct ColumnCost {
  std::uint32_t coefficients = 0;  ///< of its functional
  std::uint32_t blocks = 0;        ///< stored blocks in the lists of those, over all layers
  std::uint32_t visits = 0;        ///< of touch
};

/// A column that depends on a coefficient, and the weight.
struct SlotColumn {
  std::uint32_t column;
  float weight;
};

/// Memory of assemble_capacitance. A coefficient of the set's functionals has a slot; there are `columns` columns and
/// `entries` weights of functionals.
struct CapacitanceScratch {
  static constexpr std::uint32_t batch = 16;  ///< columns of the matrix that are summed together

  Touched touched;                           ///< of one node at a time
  PointCoefficient* coefficients = nullptr;  ///< [entries] the functionals, one after the other
  std::uint32_t* begin = nullptr;            ///< [columns + 1] of each functional
  SlotColumn* column = nullptr;              ///< [entries] the same by slots
  std::uint32_t* slot_begin = nullptr;       ///< [slots + 1] of each slot
  std::uint32_t* batch_begin = nullptr;      ///< [slots] its columns in the batch
  std::uint32_t* batch_end = nullptr;        ///< [slots]
  std::uint32_t* slot = nullptr;             ///< [domain], layout::none between calls
  Block* root = nullptr;                     ///< [slots] scale
  Block* sum = nullptr;                      ///< [slots * min(columns, batch)]
  BlockPlace* places = nullptr;              ///< [longest column + 1]
  Block* blocks = nullptr;                   ///< [longest column + 1]
};

/// Adds the blocks, of all layers, that level q stores to the counts of both of their coefficients. degree: [domain of
/// K(q)]. Start-up.
void add_degrees(const ModelView& view, std::uint32_t q, std::uint32_t* degree) noexcept;

/// What the node at `place` of K(c) costs. degree: by levels 0..c, as add_degrees counts. Start-up.
[[nodiscard]] ColumnCost column_cost(const Refinement& refinement, std::uint32_t c, std::uint32_t place,
                                     const std::uint32_t* degree, Touched& touched) noexcept;

/// Work units of assemble_capacitance. visits, coefficients, blocks: ColumnCost summed over the columns of the set;
/// slots: coefficients that the set touches, and stored: blocks in the columns of those in all layers, none counted
/// twice.
constexpr std::uint64_t assemble_capacitance_work(std::uint64_t columns, std::uint64_t slots, std::uint64_t stored,
                                                  std::uint64_t visits, std::uint64_t coefficients,
                                                  std::uint64_t blocks) {
  const std::uint64_t batches = (columns + CapacitanceScratch::batch - 1) / CapacitanceScratch::batch;
  return 5 * visits + 16 * coefficients + 16 * slots + batches * (68 * slots + 74 * stored) + 9 * blocks +
         columns * (3 * slots + 9 * coefficients);
}

/// The capacitance matrix of a contact set in force form: block (i, j) is the displacement of the average of column i
/// per force at column j (James & Pai 2003, sections 3.2 and 5.4), by all layers. Every block between two touched
/// coefficients is read once per batch of columns. Symmetric; only the lower triangle is written. touched: by the set;
/// a: [n * n / 4] by columns, n = padded_order(3 * columns); force: [domain], 0 before and after. For the loop; work:
/// assemble_capacitance_work.
void assemble_capacitance(const Refinement& refinement, const ContactSet& set, const Touched& touched,
                          CapacitanceScratch& scratch, Float4* force, Float4* a) noexcept;

}  // namespace greenloop
