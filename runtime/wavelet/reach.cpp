#include "runtime/wavelet/reach.hpp"

#include "runtime/wavelet/column.hpp"

namespace greenloop {
namespace {

void add(Touched& touched, std::uint32_t level, std::uint32_t place) {
  const bool known = touched.mark[place];
  touched.list[level][touched.count[level]] = place;
  touched.count[level] += known ? 0 : 1;
  touched.mark[place] = true;
}

std::uint64_t neighbour_visits(const Refinement& refinement, std::uint32_t level, std::uint32_t even) {
  const std::uint32_t* begin = refinement.lifting->begin[level] + even;
  return std::uint64_t{OddNeighbours::most} * (begin[1] - begin[0]);
}

}  // namespace

void Touched::carve(Arena& arena, const ModelView& view) noexcept {
  // a rejected place is written behind the last accepted one
  auto* lists = arena.take<std::uint32_t>(view.domain_count + std::uint64_t{view.levels});
  mark = arena.take_zeroed<bool>(view.domain_count);
  for (std::uint32_t q = 0; q < view.levels && lists != nullptr; ++q) {
    list[q] = lists;
    lists += view.level[q].counts->domain_count + 1;
  }
}

std::uint64_t Touched::coefficients() const noexcept {
  std::uint64_t sum = 0;
  for (const std::uint32_t of_level : count) {
    sum += of_level;
  }
  return sum;
}

void touch(const Refinement& refinement, const std::uint32_t* column, std::uint32_t count, Touched& touched) noexcept {
  touched.finest = count > 0 ? column_level(column[count - 1]) : 0;
  touched.visits = count;
  std::uint32_t left = count;
  const auto add_columns = [&](std::uint32_t level) {
    std::uint32_t first = left;
    while (first > 0 && column_level(column[first - 1]) == level) {
      --first;
    }
    for (std::uint32_t i = first; i < left; ++i) {
      const std::uint32_t place = column_place(column[i]);
      add(touched, refinement.level[place], place);
    }
    left = first;
  };
  for (std::uint32_t level = touched.finest; level > 0; --level) {
    add_columns(level);
    touched.forced[level] = touched.count[level];
    touched.visits += std::uint64_t{refinement.prediction.length} * touched.forced[level];
    for (std::uint32_t k = 0; k < touched.forced[level]; ++k) {
      visit_prediction(refinement, touched.list[level][k],
                       [&](std::uint32_t even, auto) { add(touched, refinement.level[even], even); });
    }
    for (std::uint32_t q = 0; q < level; ++q) {
      touched.even[level][q] = touched.count[q];
      for (std::uint32_t k = 0; k < touched.count[q]; ++k) {
        touched.visits += neighbour_visits(refinement, level, touched.list[q][k]);
        visit_neighbours(refinement, level, touched.list[q][k],
                         [&](std::uint32_t odd, float) { add(touched, level, odd); });
      }
    }
  }
  add_columns(0);
}

void clear(Touched& touched) noexcept {
  for (std::uint32_t q = 0; q < layout::max_levels; ++q) {
    for (std::uint32_t k = 0; k < touched.count[q]; ++k) {
      touched.mark[touched.list[q][k]] = false;
    }
    touched.count[q] = 0;
  }
  touched.visits = 0;
}

}  // namespace greenloop
