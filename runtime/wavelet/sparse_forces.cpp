#include "runtime/wavelet/sparse_forces.hpp"

#include <cstddef>

#include "formats/stored_blocks.hpp"
#include "runtime/wavelet/column.hpp"
#include "runtime/wavelet/domain.hpp"

namespace greenloop {
namespace {

void add(Touched& touched, std::uint32_t level, std::uint32_t place) {
  const bool known = touched.mark[place];
  touched.list[level][touched.count[level]] = place;
  touched.count[level] += known ? 0 : 1;
  touched.mark[place] = true;
}

// calls visit(place, stored block) for what predicts an odd node
template <class Visit>
void visit_blocks(const Refinement& refinement, std::uint32_t odd, Visit visit) {
  const LevelView& at = refinement.view->level[refinement.level[odd]];
  const std::uint32_t terms = at.predictions.terms;
  const std::size_t first = std::size_t{terms} * (odd - at.domain_begin);
  for (std::size_t term = first; term < first + terms; ++term) {
    visit(stored_source(at.predictions, term), stored_block(at.predictions, term));
  }
}

// calls visit(place, number)
template <class Visit>
void visit_numbers(const Refinement& refinement, std::uint32_t odd, Visit visit) {
  for (const std::uint32_t parent : refinement.parents[odd].place) {
    if (parent != layout::none) {
      visit(parent, 0.5F);
    }
  }
  for (std::uint32_t k = 0; refinement.stencils != nullptr && k < 6; ++k) {
    if (refinement.stencils[odd].place[k] != layout::none) {
      visit(refinement.stencils[odd].place[k], k < 2 ? layout::wing_weight : layout::outer_weight);
    }
  }
}

// calls visit(place, weight): either
template <class Visit>
void visit_prediction(const Refinement& refinement, std::uint32_t odd, Visit visit) {
  if (refinement.prediction.blocks) {
    visit_blocks(refinement, odd, visit);
  } else {
    visit_numbers(refinement, odd, visit);
  }
}

// what a force on an odd node adds to one that predicts it with a weight
Float4 shared(float weight, Float4 force) { return splat(weight) * force; }

Float4 shared(const std::byte* weight, Float4 force) {
  return splat(weight_unit) * transposed_product(StoredBlock<16>::load(weight), force);
}

// calls visit(place of the odd neighbour, lift) for the neighbours in M(level) of an even node
template <class Visit>
void visit_neighbours(const Refinement& refinement, std::uint32_t level, std::uint32_t even, Visit visit) {
  const LevelView& at = refinement.view->level[level];
  const std::uint32_t* begin = refinement.lifting->begin[level] + even;
  for (std::uint32_t n = begin[0]; n < begin[1]; ++n) {
    const OddNeighbours& record = refinement.lifting->neighbours[level][n];
    for (std::uint32_t k = 0; k < record.count; ++k) {
      visit(record.node(k) - at.node_begin + at.domain_begin, record.lift[k]);
    }
  }
}

std::uint64_t neighbour_visits(const Refinement& refinement, std::uint32_t level, std::uint32_t even) {
  const std::uint32_t* begin = refinement.lifting->begin[level] + even;
  return std::uint64_t{OddNeighbours::most} * (begin[1] - begin[0]);
}

void list_parents(const ModelView& view, DomainParents* parents) {
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    const LevelView& at = view.level[q];
    for (std::uint32_t i = 0; i < at.counts->domain_count; ++i) {
      for (std::uint32_t side = 0; side < 2; ++side) {
        const std::uint32_t parent = q == 0 ? layout::none : at.refinement[i].parent[side];
        const bool stored = q > 0 && in_domain(view, parent);
        parents[at.domain_begin + i].place[side] = stored ? domain_place(view, parent) : layout::none;
      }
    }
  }
}

void list_stencils(const ModelView& view, DomainStencil* stencils) {
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    const LevelView& at = view.level[q];
    for (std::uint32_t i = 0; i < at.counts->domain_count; ++i) {
      for (std::uint32_t k = 0; k < 6; ++k) {
        const std::uint32_t node = at.stencils == nullptr ? layout::none
                                   : k < 2                ? at.stencils[i].wing[k]
                                                          : at.stencils[i].outer[k - 2];
        const bool stored = node != layout::none && in_domain(view, node);
        stencils[at.domain_begin + i].place[k] = stored ? domain_place(view, node) : layout::none;
      }
    }
  }
}

}  // namespace

void RefinementTables::carve(Arena& arena, const ModelView& view) noexcept {
  for (std::uint32_t q = 1; q < view.levels; ++q) {
    begin_[q] = arena.take<std::uint32_t>(domain_up_to(view, q - 1) + std::uint64_t{1});
    neighbours_[q] = arena.take<OddNeighbours>(count_lifting(view, q).records);
  }
  if (!prediction_of(view).blocks) {
    parents_ = arena.take<DomainParents>(view.domain_count);
  }
  if (layout::is_butterfly(static_cast<layout::Wavelet>(view.info->wavelet))) {
    stencils_ = arena.take<DomainStencil>(view.domain_count);
  }
  level_ = arena.take<std::uint8_t>(view.domain_count);
}

void RefinementTables::fill(const ModelView& view) noexcept {
  if (parents_ != nullptr) {
    list_parents(view, parents_);
  }
  if (stencils_ != nullptr) {
    list_stencils(view, stencils_);
  }
  for (std::uint32_t q = 1; q < view.levels; ++q) {
    list_odd_neighbours(view, q, begin_[q], neighbours_[q]);
  }
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    const LevelView& at = view.level[q];
    for (std::uint32_t i = 0; i < at.counts->domain_count; ++i) {
      level_[at.domain_begin + i] = static_cast<std::uint8_t>(q);
    }
  }
}

Refinement RefinementTables::refinement(const ModelView& view, Lifting& lifting) const noexcept {
  for (std::uint32_t q = 1; q < view.levels; ++q) {
    lifting.begin[q] = begin_[q];
    lifting.neighbours[q] = neighbours_[q];
  }
  return {&view, &lifting, prediction_of(view), parents_, stencils_, level_};
}

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

void clear_forces(const Touched& touched, Float4* force) noexcept {
  for (std::uint32_t q = 0; q < layout::max_levels; ++q) {
    for (std::uint32_t k = 0; k < touched.count[q]; ++k) {
      force[touched.list[q][k]] = Float4{};
    }
  }
}

}  // namespace greenloop
