#include "runtime/field.hpp"

#include <cstring>

#include "runtime/domain.hpp"

namespace greenloop {
namespace {

// scales the forces and adds the diagonal blocks
void scale_forces(const Coefficients& coefficients, const Touched& touched, std::uint32_t field_level, Float4* force,
                  Float4* sum) {
  for (std::uint32_t g = 0; g < Coefficients::groups; ++g) {
    const CoefficientGroup& group = coefficients.group[g];
    const bool diagonal = Coefficients::has_diagonal(g) && group.level <= field_level;
    for (std::uint32_t k = 0; k < touched.count[g]; ++k) {
      const std::uint32_t i = touched.list[g][k];
      const layout::Scale& scale = group.scale[i - group.begin];
      force[i] = without_denormals(symmetric_product(scale.root, force[i]));
      if (diagonal) {
        sum[i] += symmetric_product(scale.diagonal, force[i]);
      }
    }
  }
}

// scaled back: details and averages of level 0 to the nodes, zero outside the domain and above the field level
void scale_back(const ModelView& view, const Coefficients& coefficients, std::uint32_t field_level, Float4* sum,
                Float4* x) {
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    const LevelView& level = view.level[q];
    const CoefficientGroup& group = coefficients.group[Coefficients::details(q)];
    Float4* to = x + level.node_begin;
    Float4* from = sum + group.begin;
    const std::uint32_t kept = q <= field_level ? group.count : 0;
    for (std::uint32_t i = 0; i < kept; ++i) {
      to[i] = symmetric_product(group.scale[i].root, from[i]);
      from[i] = Float4{};
    }
    std::memset(to + kept, 0, sizeof(Float4) * (level.counts->node_count - kept));
  }
  for (std::uint32_t m = 1; m <= coefficients.last_averages && m <= field_level; ++m) {
    const CoefficientGroup& group = coefficients.group[Coefficients::averages(m)];
    for (std::uint32_t i = 0; i < group.count; ++i) {
      sum[group.begin + i] = symmetric_product(group.scale[i].root, sum[group.begin + i]);
    }
  }
}

}  // namespace

void compute_field(const FieldModel& model, const Touched& touched, std::uint32_t field_level, Float4* force,
                   Float4* sum, Float4* x) noexcept {
  const ModelView& view = *model.refinement.view;
  const Coefficients& coefficients = model.coefficients;
  transform_forces(model.refinement, coefficients, touched, force);
  scale_forces(coefficients, touched, field_level, force, sum);
  for (std::uint32_t s = 0; s < model.couplings.count; ++s) {
    const CouplingSection& section = model.couplings.section[s];
    const std::uint32_t columns = section.column_group;
    const std::uint32_t rows = section.row_group;
    const std::uint32_t column_begin = coefficients.group[columns].begin;
    const std::uint32_t row_begin = coefficients.group[rows].begin;
    if (in_field(view, section) && section.row_level <= field_level) {
      add_direct(section, {touched.list[columns], touched.count[columns], column_begin, force}, sum + row_begin);
    }
    if (in_field(view, section) && section.column_level <= field_level) {
      add_mirrored(section, {touched.list[rows], touched.count[rows], row_begin, force}, sum + column_begin);
    }
  }
  clear_forces(touched, force);
  scale_back(view, coefficients, field_level, sum, x);

  const Float4* averages[layout::max_levels] = {};
  for (std::uint32_t m = 1; m <= coefficients.last_averages && m <= field_level; ++m) {
    averages[m] = sum + coefficients.group[Coefficients::averages(m)].begin;
  }
  inverse_transform(view, *model.refinement.lifting, field_level, averages, x);
  std::memset(sum + view.domain_count, 0, sizeof(Float4) * (coefficients.count - view.domain_count));
}

}  // namespace greenloop
