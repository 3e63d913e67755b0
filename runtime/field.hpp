#pragma once

#include <cstdint>

#include "formats/view.hpp"
#include "runtime/field_columns.hpp"
#include "runtime/wavelet.hpp"

namespace greenloop {

/// What compute_field reads.
struct FieldModel {
  const ModelView& view;
  const FieldColumns& columns;
  const ParentOffsets* parents;  ///< [domain]
};

/// Forces on columns.
struct ColumnForces {
  std::uint32_t count;
  const std::uint32_t* column;  ///< [count]
  const float* force;           ///< [3 * count] N
};

/// Fast summation (James & Pai 2003, section 5.4): the displacement of the nodes of K(levels.nodes) by some forces,
/// with details up to levels.details, interpolated beyond. scratch: zero before and after; x: [nodes of
/// K(levels.nodes)], all of which are written. For the loop; work: field_work.
void compute_field(const FieldModel& model, const ColumnForces& forces, const FieldLevels& levels,
                   const SparseCoefficients& scratch, Float4* x) noexcept;

}  // namespace greenloop
