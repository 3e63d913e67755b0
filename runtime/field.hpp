#pragma once

#include <cstdint>

#include "runtime/couplings.hpp"
#include "runtime/sparse_forces.hpp"

namespace greenloop {

/// What compute_field reads.
struct FieldModel {
  const Refinement& refinement;
  const Coefficients& coefficients;
  const Couplings& couplings;
};

/// Whether a layer of couplings is part of the field.
inline bool in_field(const ModelView& view, const CouplingSection& section) {
  return section.layer < view.info->field_layers;
}

/// Finest details that forces of level c reach: beyond, they couple with averages that nobody knows.
constexpr std::uint32_t whole_field_level(std::uint32_t c, std::uint32_t levels) {
  return c + 2 < levels - 1 ? c + 2 : levels - 1;
}

/// Fast summation (James & Pai 2003, section 5.4) of the two-sided form: the displacement of every node by the forces
/// on the touched nodes, with details up to `field_level`, interpolated beyond.
/// force: [coefficients], nodal forces on the touched places of K(c); both it and sum, [coefficients], are 0 elsewhere
/// before and everywhere after. x: [node_count]. For the loop; work: field_work.
void compute_field(const FieldModel& model, const Touched& touched, std::uint32_t field_level, Float4* force,
                   Float4* sum, Float4* x) noexcept;

}  // namespace greenloop
