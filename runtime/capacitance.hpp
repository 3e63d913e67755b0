#pragma once

#include <cstdint>

#include "runtime/arena.hpp"
#include "runtime/contact_set.hpp"
#include "runtime/couplings.hpp"
#include "runtime/sparse_forces.hpp"

namespace greenloop {

/// A coefficient that a node's displacement depends on, and the weight: a row of T^-1, that is a column of T^-T.
struct PointCoefficient {
  std::uint32_t coefficient;
  float weight;
};

/// The coefficients of one node, group by group.
struct PointFunctional {
  std::uint32_t begin[Coefficients::groups + 1];  ///< of each group, in the coefficients of the whole set
};

/// Where a node of K(c) meets others of K(c): only coefficients whose displacement forces of level c reach.
constexpr bool in_capacitance(std::uint32_t group, std::uint32_t c) {
  return Coefficients::has_diagonal(group) || group - layout::max_levels + 2 <= c;
}

/// What a node costs as a column of the capacitance matrix.
struct ColumnCost {
  std::uint32_t coefficients = 0;  ///< of its functional
  std::uint32_t blocks = 0;        ///< stored blocks in the lists of those, over both layers
  std::uint32_t visits = 0;        ///< of touch
};

/// Memory of assemble_capacitance.
struct CapacitanceScratch {
  Touched touched;                           ///< of one node at a time
  PointCoefficient* coefficients = nullptr;  ///< the functionals of all columns of a set, one after the other
  PointFunctional* functional = nullptr;     ///< [columns]
  std::uint32_t* slot = nullptr;             ///< [coefficients], layout::none between calls
  std::uint32_t* slotted = nullptr;          ///< [coefficients], the coefficient of each slot
  Block* root = nullptr;                     ///< [slots] its scale
  Block* sum = nullptr;                      ///< [slots]
  BlockPlace* chosen = nullptr;              ///< [longest list + 1]
};

/// What assemble_capacitance reads.
struct CapacitanceModel {
  const Refinement& refinement;
  const Coefficients& coefficients;
  const Couplings& couplings;
};

/// What the node at `place` of K(c) costs. force: [coefficients], 0. Start-up.
[[nodiscard]] ColumnCost column_cost(const CapacitanceModel& model, std::uint32_t c, std::uint32_t place,
                                     Touched& touched) noexcept;

/// Work units of assemble_capacitance, the costs summed over the columns of the set. `slots`: coefficients of all
/// functionals together, none counted twice.
constexpr std::uint64_t assemble_capacitance_work(std::uint64_t columns, std::uint64_t slots, std::uint64_t visits,
                                                  std::uint64_t coefficients, std::uint64_t blocks) {
  return 5 * visits + 24 * coefficients + 12 * slots + columns * (30 * slots + 9 * coefficients) + 9 * blocks;
}

/// The capacitance matrix of a contact set in force form: block (i, j) is the displacement of the average of column i
/// per force at column j (James & Pai 2003, sections 3.2 and 5.4), by the non-standard form of both layers. Symmetric;
/// only the lower triangle is written. a: [n * n / 4] by columns, n = padded_order(3 * columns); force:
/// [coefficients], 0 before and after. For the loop; work: assemble_capacitance_work.
void assemble_capacitance(const CapacitanceModel& model, const ContactSet& set, CapacitanceScratch& scratch,
                          Float4* force, Float4* a) noexcept;

}  // namespace greenloop
