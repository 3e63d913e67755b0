#pragma once

#include <cstdint>

#include "runtime/block_columns.hpp"
#include "runtime/contact_set.hpp"
#include "runtime/point_functional.hpp"

namespace greenloop {

/// Memory of assemble_capacitance.
struct CapacitanceScratch {
  Block* blocks = nullptr;                   ///< [node_count], zero between calls
  PointCoefficient* coefficients = nullptr;  ///< the functionals of all columns of a set, one after the other
  std::uint32_t* begin = nullptr;            ///< [columns + 1] of each functional
};

/// Work units of assemble_capacitance: `coefficients` over all functionals, `blocks` over all columns.
constexpr std::uint64_t assemble_capacitance_work(std::uint64_t columns, std::uint64_t coefficients,
                                                  std::uint64_t blocks) {
  return 2 * coefficients + 12 * blocks + 9 * columns * coefficients;
}

/// The capacitance matrix of a contact set in force form: block (i, j) is the displacement of the centre of column i
/// per force at column j (James & Pai 2003, sections 3.2 and 5.4). It is not exactly symmetric: columns are thresholded
/// and quantised one by one. a: [n * n / 4] by columns, n = lu_padded(3 * columns). For the loop.
void assemble_capacitance(const ModelView& view, const Lifting& lifting, const ContactSet& set,
                          CapacitanceScratch& scratch, Float4* a) noexcept;

}  // namespace greenloop
