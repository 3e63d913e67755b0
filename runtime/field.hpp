#pragma once

#include <cstdint>

#include "runtime/field_couplings.hpp"
#include "runtime/sparse_forces.hpp"

namespace greenloop {

/// What compute_field reads.
struct FieldModel {
  const Refinement& refinement;
  const FieldCouplings& couplings;
};

/// Fast summation (James & Pai 2003, section 5.4) of the two-sided form: the displacement of every node by the forces
/// on the touched nodes, with details up to `field_level`, interpolated beyond.
/// force: [domain], nodal forces on the touched places of K(c), 0 elsewhere before and everywhere after. x:
/// [node_count]. For the loop; work: field_work.
void compute_field(const FieldModel& model, const Touched& touched, std::uint32_t field_level, Float4* force,
                   Float4* x) noexcept;

}  // namespace greenloop
