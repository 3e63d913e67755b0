#include "runtime/field.hpp"

#include <cstring>

#include "runtime/domain.hpp"

namespace greenloop {

void compute_field(const FieldModel& model, const ColumnForces& forces, const FieldLevels& levels,
                   std::uint8_t* touched, Float4* x) noexcept {
  constexpr std::uint32_t ahead = 2;  // columns that are on their way while one is summed
  const SparseCoefficients coefficients{x, touched};
  std::memset(x, 0, sizeof(Float4) * nodes_up_to(model.view, levels.nodes));
  for (std::uint32_t k = 0; k < forces.count; ++k) {
    if (k + ahead < forces.count) {
      prefetch_column(model.columns, forces.column[k + ahead]);
    }
    const float* at = forces.force + std::size_t{3} * k;
    const Float4 force = without_denormals(Float4{at[0], at[1], at[2], 0.0F});
    add_column(model.columns, forces.column[k], levels.details, force, coefficients);
  }
  inverse_transform(model.view, model.parents, levels, coefficients);
}

}  // namespace greenloop
