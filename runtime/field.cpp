#include "runtime/field.hpp"

namespace greenloop {

void compute_field(const FieldModel& model, const ColumnForces& forces, const FieldLevels& levels,
                   const SparseCoefficients& scratch, Float4* x) noexcept {
  constexpr std::uint32_t ahead = 2;  // columns that are on their way while one is summed
  for (std::uint32_t k = 0; k < forces.count; ++k) {
    if (k + ahead < forces.count) {
      prefetch_column(model.columns, forces.column[k + ahead]);
    }
    const float* at = forces.force + std::size_t{3} * k;
    const Float4 force = without_denormals(Float4{at[0], at[1], at[2], 0.0F});
    add_column(model.columns, forces.column[k], levels.details, force, scratch);
  }
  inverse_transform(model.view, model.parents, levels, scratch, x);
}

}  // namespace greenloop
