#include "runtime/compliance/functionals.hpp"

#include <cstddef>
#include <cstring>

namespace greenloop {
namespace {

// calls take(n, coefficient) for the n-th that a force on a column reaches, while `force` holds what it is there
template <unsigned N, class Take>
void transform_force(const Refinement& refinement, std::uint32_t column, const float (&of_column)[N],
                     const Touched& touched, Vector<N>* force, Take take) {
  transform_forces<N>(refinement, {1, &column, of_column}, touched, force);
  std::uint32_t n = 0;
  for (std::uint32_t q = 0; q <= touched.finest; ++q) {
    for (std::uint32_t k = 0; k < touched.count[q]; ++k) {
      take(n++, touched.list[q][k]);
    }
  }
  clear_forces<N>(touched, force);
}

template <unsigned N>
void write_numbers(const Refinement& refinement, std::uint32_t column, const std::uint32_t* slot,
                   const Touched& touched, Vector<N>* force, PointCoefficient* coefficients) {
  const float along_first[N] = {1};  // weights are alike along all axes
  transform_force<N>(refinement, column, along_first, touched, force, [&](std::uint32_t n, std::uint32_t coefficient) {
    coefficients[n] = {slot[coefficient], component(force[coefficient], 0)};
  });
}

template <unsigned N>
void write_blocks(const Refinement& refinement, std::uint32_t column, const std::uint32_t* slot, const Touched& touched,
                  Vector<N>* force, PointCoefficient* coefficients, Block<N>* block) {
  for (std::size_t axis = 0; axis < N; ++axis) {
    float unit[N] = {};
    unit[axis] = 1;
    transform_force<N>(refinement, column, unit, touched, force, [&](std::uint32_t n, std::uint32_t coefficient) {
      coefficients[n] = {slot[coefficient], 1};
      block[n].column[axis] = force[coefficient];
    });
  }
  for (std::size_t n = 0; n < touched.coefficients(); ++n) {
    block[n] = transposed(block[n]);
  }
}

// the weights by slots
template <unsigned N>
void list_slot_rows(std::uint32_t rows, std::uint32_t slots, Functionals<N>& functionals) {
  std::uint32_t* begin = functionals.slot_begin;
  std::memset(begin, 0, sizeof(std::uint32_t) * (slots + std::size_t{1}));
  for (std::uint32_t k = 0; k < functionals.begin[rows]; ++k) {
    ++begin[functionals.coefficients[k].slot];
  }
  for (std::uint32_t s = 0; s < slots; ++s) {
    begin[s + 1] += begin[s];
  }
  for (std::uint32_t i = rows; i-- > 0;) {
    for (std::uint32_t k = functionals.begin[i]; k < functionals.begin[i + 1]; ++k) {
      const PointCoefficient& at = functionals.coefficients[k];
      functionals.row[--begin[at.slot]] = {2 * slots * (i / 2) + i % 2, at.weight};
      if (functionals.block != nullptr) {
        functionals.block_of_row[begin[at.slot]] = k;
      }
    }
  }
}

}  // namespace

template <unsigned N>
void Functionals<N>::carve(Arena& arena, std::uint64_t columns, std::uint64_t entries, std::uint64_t slots,
                           const Prediction& prediction) noexcept {
  coefficients = arena.take<PointCoefficient>(entries);
  begin = arena.take<std::uint32_t>(columns + 1);
  row = arena.take<SlotRow>(entries);
  slot_begin = arena.take<std::uint32_t>(slots + 1);
  if (prediction.blocks) {
    block = arena.take<Block<N>>(entries);
    block_of_row = arena.take<std::uint32_t>(entries);
  }
}

template <unsigned N>
void list_functionals(const Refinement& refinement, const SlottedColumns& columns, Touched& touched, Vector<N>* force,
                      Functionals<N>& functionals) noexcept {
  functionals.begin[0] = 0;
  for (std::uint32_t i = 0; i < columns.count; ++i) {
    const std::uint32_t column = columns.column[i];
    const std::uint32_t begin = functionals.begin[i];
    touch(refinement, &column, 1, touched);
    if (refinement.prediction.blocks) {
      write_blocks<N>(refinement, column, columns.slot, touched, force, functionals.coefficients + begin,
                      functionals.block + begin);
    } else {
      write_numbers<N>(refinement, column, columns.slot, touched, force, functionals.coefficients + begin);
    }
    functionals.begin[i + 1] = begin + static_cast<std::uint32_t>(touched.coefficients());
    clear(touched);
  }
  list_slot_rows(columns.count, columns.slots, functionals);
}

template <unsigned N>
void add_by_blocks(const Functionals<N>& functionals, std::uint32_t slot, const Block<N>& block,
                   Block<N>* sum) noexcept {
  const BlockSplats<N> of_block = splats(block);
  for (std::uint32_t k = functionals.slot_begin[slot]; k < functionals.slot_begin[slot + 1]; ++k) {
    add(product(functionals.block[functionals.block_of_row[k]], of_block), sum[functionals.row[k].first]);
  }
}

template struct Functionals<1>;
template struct Functionals<3>;
template void list_functionals<1>(const Refinement&, const SlottedColumns&, Touched&, Vector<1>*,
                                  Functionals<1>&) noexcept;
template void list_functionals<3>(const Refinement&, const SlottedColumns&, Touched&, Vector<3>*,
                                  Functionals<3>&) noexcept;
template void add_by_blocks<1>(const Functionals<1>&, std::uint32_t, const Block<1>&, Block<1>*) noexcept;
template void add_by_blocks<3>(const Functionals<3>&, std::uint32_t, const Block<3>&, Block<3>*) noexcept;

}  // namespace greenloop
