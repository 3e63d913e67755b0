#include "runtime/wavelet/force_transform.hpp"

#include "runtime/wavelet/column.hpp"

namespace greenloop {
namespace {

// what a force on an odd node adds to one that predicts it with a weight
template <unsigned N>
Vector<N> shared(float weight, Vector<N> force) {
  return scaled(weight, force);
}

template <unsigned N>
Vector<N> shared(const std::byte* weight, Vector<N> force) {
  return scaled(weight_unit<N>, transposed_product(StoredBlock<N, 16>::load(weight), force));
}

}  // namespace

template <unsigned N>
void transform_forces(const Refinement& refinement, const ColumnForces& columns, const Touched& touched,
                      Vector<N>* force) noexcept {
  std::uint32_t left = columns.count;
  const auto add_columns = [&](std::uint32_t level) {
    for (; left > 0 && column_level(columns.column[left - 1]) == level; --left) {
      const float* at = columns.force + std::size_t{N} * (left - 1);
      force[column_place(columns.column[left - 1])] += without_denormals(load_vector<N>(at));
    }
  };
  for (std::uint32_t level = touched.finest; level > 0; --level) {
    add_columns(level);
    for (std::uint32_t k = 0; k < touched.forced[level]; ++k) {
      const std::uint32_t odd = touched.list[level][k];
      visit_prediction(refinement, odd,
                       [&](std::uint32_t even, auto weight) { force[even] += shared<N>(weight, force[odd]); });
    }
    for (std::uint32_t q = 0; q < level; ++q) {
      for (std::uint32_t k = 0; k < touched.even[level][q]; ++k) {
        const std::uint32_t even = touched.list[q][k];
        const Vector<N> of_even = force[even];
        visit_neighbours(refinement, level, even,
                         [&](std::uint32_t odd, float lift) { force[odd] -= scaled(lift, of_even); });
      }
    }
  }
  add_columns(0);
}

template <unsigned N>
void clear_forces(const Touched& touched, Vector<N>* force) noexcept {
  for (std::uint32_t q = 0; q < layout::max_levels; ++q) {
    for (std::uint32_t k = 0; k < touched.count[q]; ++k) {
      force[touched.list[q][k]] = Vector<N>{};
    }
  }
}

template void transform_forces<1>(const Refinement&, const ColumnForces&, const Touched&, Vector<1>*) noexcept;
template void transform_forces<3>(const Refinement&, const ColumnForces&, const Touched&, Vector<3>*) noexcept;
template void clear_forces<1>(const Touched&, Vector<1>*) noexcept;
template void clear_forces<3>(const Touched&, Vector<3>*) noexcept;

}  // namespace greenloop
