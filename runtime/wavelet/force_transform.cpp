#include "runtime/wavelet/force_transform.hpp"

#include "runtime/wavelet/column.hpp"

namespace greenloop {
namespace {

// what a force on an odd node adds to one that predicts it with a weight
Float4 shared(float weight, Float4 force) { return splat(weight) * force; }

Float4 shared(const std::byte* weight, Float4 force) {
  return splat(weight_unit) * transposed_product(StoredBlock<16>::load(weight), force);
}

}  // namespace

void transform_forces(const Refinement& refinement, const ColumnForces& columns, const Touched& touched,
                      Float4* force) noexcept {
  std::uint32_t left = columns.count;
  const auto add_columns = [&](std::uint32_t level) {
    for (; left > 0 && column_level(columns.column[left - 1]) == level; --left) {
      const float* at = columns.force + std::size_t{3} * (left - 1);
      force[column_place(columns.column[left - 1])] += without_denormals(Float4{at[0], at[1], at[2], 0.0F});
    }
  };
  for (std::uint32_t level = touched.finest; level > 0; --level) {
    add_columns(level);
    for (std::uint32_t k = 0; k < touched.forced[level]; ++k) {
      const std::uint32_t odd = touched.list[level][k];
      visit_prediction(refinement, odd,
                       [&](std::uint32_t even, auto weight) { force[even] += shared(weight, force[odd]); });
    }
    for (std::uint32_t q = 0; q < level; ++q) {
      for (std::uint32_t k = 0; k < touched.even[level][q]; ++k) {
        const std::uint32_t even = touched.list[q][k];
        const Float4 of_even = force[even];
        visit_neighbours(refinement, level, even,
                         [&](std::uint32_t odd, float lift) { force[odd] -= splat(lift) * of_even; });
      }
    }
  }
  add_columns(0);
}

void clear_forces(const Touched& touched, Float4* force) noexcept {
  for (std::uint32_t q = 0; q < layout::max_levels; ++q) {
    for (std::uint32_t k = 0; k < touched.count[q]; ++k) {
      force[touched.list[q][k]] = Float4{};
    }
  }
}

}  // namespace greenloop
