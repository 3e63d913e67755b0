#include "runtime/field.hpp"

#include <cstring>

namespace greenloop {
namespace {

// displacements of the coefficients of levels 0..field_level by the forces on those of level q
void add_level(const FieldModel& model, const Touched& touched, std::uint32_t q, std::uint32_t field_level,
               Float4* force, Float4* x) {
  constexpr std::uint32_t ahead = 3;  // coefficients whose lists are on their way while one is summed
  const LevelView& level = model.refinement.view->level[q];
  const std::uint32_t* list = touched.list[q];
  const std::uint32_t count = touched.count[q];
  for (std::uint32_t k = 0; k < count; ++k) {
    if (k + ahead < count) {
      prefetch_couplings(model.couplings, list[k + ahead]);
    }
    const std::uint32_t i = list[k];
    const Float4 own = without_denormals(force[i]);
    force[i] = Float4{};
    if (q <= field_level) {
      x[level.node_begin + (i - level.domain_begin)] += product(symmetric_block(model.couplings.own[i].element), own);
    }
    add_couplings(model.couplings, i, field_level, own, x);
  }
}

}  // namespace

void compute_field(const FieldModel& model, const Touched& touched, std::uint32_t field_level, Float4* force,
                   Float4* x) noexcept {
  const ModelView& view = *model.refinement.view;
  transform_forces(model.refinement, touched, force);
  std::memset(x, 0, sizeof(Float4) * view.node_count);
  for (std::uint32_t q = 0; q <= touched.constraint_level; ++q) {
    add_level(model, touched, q, field_level, force, x);
  }
  inverse_transform(view, *model.refinement.lifting, field_level, x);
}

}  // namespace greenloop
