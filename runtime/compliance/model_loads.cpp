#include "runtime/compliance/model_loads.hpp"

#include <cmath>
#include <cstddef>

namespace greenloop {
namespace {

// of a coefficient by its place in its level
void add_to(const LevelView& level, const ActingLoads& loads, std::uint32_t own, Float4& x) {
  for (std::uint32_t k = 0; k < loads.count; ++k) {
    const float* const column = level.load_column(loads.load[k]) + std::size_t{3} * own;
    x = added(x, without_denormals(scaled(loads.amount[k], load_vector<3>(column))));
  }
}

}  // namespace

void add_loads(const ModelView& view, const ActingLoads& loads, const Touched& touched, Float4* x) noexcept {
  for (std::uint32_t q = 0; q <= touched.finest; ++q) {
    const LevelView& level = view.level[q];
    for (std::uint32_t k = 0; k < touched.count[q]; ++k) {
      const std::uint32_t place = touched.list[q][k];
      add_to(level, loads, place - level.domain_begin, x[place]);
    }
  }
}

void add_loads(const ModelView& view, const ActingLoads& loads, std::uint32_t details, Float4* x) noexcept {
  for (std::uint32_t q = 0; q <= details && loads.count > 0; ++q) {
    const LevelView& level = view.level[q];
    for (std::uint32_t i = 0; i < level.counts->domain_count; ++i) {
      add_to(level, loads, i, x[level.domain_begin + i]);
    }
  }
}

double largest_coefficient(const ModelView& view, std::uint32_t load) noexcept {
  double largest = 0;
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    const float* const column = view.level[q].load_column(load);
    for (std::size_t i = 0; i < std::size_t{3} * view.level[q].counts->domain_count; ++i) {
      const double size = std::fabs(double{column[i]});
      largest = size > largest ? size : largest;
    }
  }
  return largest;
}

}  // namespace greenloop
