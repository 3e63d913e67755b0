#include "runtime/wavelet/sparse_inverse.hpp"

#include "runtime/wavelet/column.hpp"

namespace greenloop {

void SparseInverse::carve(Arena& arena, std::uint64_t slots, const Prediction& prediction) noexcept {
  // a slot is predicted once, lifted into two unless with blocks, and may be copied from another
  const std::uint64_t lifts = prediction.blocks ? 0 : 2;
  step = arena.take<Step>((2 + lifts) * slots);
  term = arena.take<Term>(slots * (prediction.length + 1 + lifts));
  settled = arena.take<std::uint32_t>(slots);
  if (prediction.blocks) {
    block = arena.take<const std::byte*>(2 * slots);
  }
}

void list_inverse(const Refinement& refinement, const Touched& touched, const std::uint32_t* slot,
                  const InverseAnswers& answers, SparseInverse& inverse) noexcept {
  std::uint32_t terms = 0;
  inverse.steps = 0;
  const auto add_term = [&](std::uint32_t place, float weight) { inverse.term[terms++] = {slot[place], weight}; };
  const auto end_step = [&](std::uint32_t target, const std::byte* block = nullptr) {
    const std::uint32_t begin = inverse.steps == 0 ? 0 : inverse.step[inverse.steps - 1].end;
    if (terms > begin) {
      if (inverse.block != nullptr) {
        inverse.block[inverse.steps] = block;
      }
      inverse.step[inverse.steps++] = {target, terms};
      inverse.settled[target] = inverse.steps;
    }
  };
  const auto copy_columns = [&](std::uint32_t level) {
    for (std::uint32_t i = 0; i < answers.count; ++i) {
      const std::uint32_t place = column_place(answers.column[i]);
      if (column_level(answers.column[i]) == level && answers.slot[i] != slot[place]) {
        add_term(place, 1);
        end_step(answers.slot[i]);
      }
    }
  };
  for (std::uint32_t q = 0; q <= touched.finest; ++q) {
    for (std::uint32_t k = 0; k < touched.count[q]; ++k) {
      inverse.settled[slot[touched.list[q][k]]] = 0;
    }
  }
  copy_columns(0);
  for (std::uint32_t level = 1; level <= touched.finest; ++level) {
    for (std::uint32_t q = 0; q < level; ++q) {
      for (std::uint32_t k = 0; k < touched.even[level][q]; ++k) {
        const std::uint32_t even = touched.list[q][k];
        visit_neighbours(refinement, level, even, [&](std::uint32_t odd, float lift) { add_term(odd, -lift); });
        end_step(slot[even]);
      }
    }
    for (std::uint32_t k = 0; k < touched.forced[level]; ++k) {
      const std::uint32_t odd = touched.list[level][k];
      const std::byte* first = nullptr;
      if (refinement.prediction.blocks) {
        visit_blocks(refinement, odd, [&](std::uint32_t even, const std::byte* block) {
          first = first == nullptr ? block : first;
          add_term(even, 1);
        });
      } else {
        visit_numbers(refinement, odd, add_term);
      }
      end_step(slot[odd], first);
    }
    copy_columns(level);
  }
}

}  // namespace greenloop
