#pragma once

#include <cstdint>

#include "runtime/algebra/block.hpp"
#include "runtime/memory/arena.hpp"
#include "runtime/wavelet/force_transform.hpp"
#include "runtime/wavelet/reach.hpp"
#include "runtime/wavelet/refinement.hpp"

namespace greenloop {

/// A coefficient, by its slot, that a node's displacement depends on, and the weight: together a row of T^-1, which is
/// a column of T^-T.
struct PointCoefficient {
  std::uint32_t slot;
  float weight;
};

/// A row of a matrix that depends on a coefficient and the weight.
struct SlotRow {
  std::uint32_t first;  ///< its sum of slot 0, counted in blocks, of sums of two rows each
  float weight;
};

/// Functionals: what the displacements of some columns depend on. With block predictions each weight is times a block,
/// the displacement of the column per displacement of the coefficient.
template <unsigned N>
struct Functionals {
  PointCoefficient* coefficients = nullptr;  ///< [entries] one functional after the other
  std::uint32_t* begin = nullptr;            ///< [columns + 1] of each functional
  SlotRow* row = nullptr;                    ///< [entries] the same by slots
  std::uint32_t* slot_begin = nullptr;       ///< [slots + 1] of each slot
  Block<N>* block = nullptr;                 ///< [entries] of `coefficients`; null where weights are numbers
  std::uint32_t* block_of_row = nullptr;     ///< [entries] of `row`, in `block`; null as well

  /// Arrays out of `arena`; null while it counts.
  void carve(Arena& arena, std::uint64_t columns, std::uint64_t entries, std::uint64_t slots,
             const Prediction& prediction) noexcept;
};

/// Some columns, and where their coefficients have slots.
struct SlottedColumns {
  std::uint32_t count;
  const std::uint32_t* column;  ///< [count]
  std::uint32_t slots;
  const std::uint32_t* slot;  ///< [domain]
};

/// Lists the functionals of some columns. touched: clear before and after; force: [domain], 0 before and after. For the
/// loop; work: a unit per column and slot, and per column that of touch and of transform_forces, which with blocks is
/// done for each axis, and 16 for each of its coefficients each time.
template <unsigned N>
void list_functionals(const Refinement& refinement, const SlottedColumns& columns, Touched& touched, Vector<N>* force,
                      Functionals<N>& functionals) noexcept;

/// sum += weight times `block` for each row that depends on a slot; sum: of their SlotRow::first. With block
/// predictions. For the loop; work: meeting_price per row.
template <unsigned N>
void add_by_blocks(const Functionals<N>& functionals, std::uint32_t slot, const Block<N>& block,
                   Block<N>* sum) noexcept;

}  // namespace greenloop
