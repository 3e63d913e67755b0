#include "runtime/compliance/selected_columns.hpp"

#include <cstddef>
#include <type_traits>

#include "runtime/algebra/stored_block.hpp"
#include "runtime/compliance/couplings.hpp"

namespace greenloop {
namespace {

template <class Visit>
void visit_coefficients(const Touched& touched, Visit visit) {
  for (std::uint32_t q = 0; q <= touched.finest; ++q) {
    for (std::uint32_t k = 0; k < touched.count[q]; ++k) {
      visit(touched.list[q][k]);
    }
  }
}

// calls visit(row, block) for the stored blocks of a coefficient's column in rows that are marked; returns their number
template <class Stored, class Visit>
std::uint64_t visit_marked(const CouplingsView& couplings, std::uint32_t column, const bool* mark, Visit visit) {
  if (couplings.columns == 0) {
    return 0;
  }
  std::uint64_t found = 0;
  for (std::uint32_t position = couplings.begin[column]; position < couplings.begin[column + 1]; ++position) {
    const std::uint32_t row = stored_row(couplings, position);
    if (mark[row]) {
      visit(row, Stored::load(couplings.value + Stored::bytes * std::size_t{position}));
      ++found;
    }
  }
  return found;
}

// a coefficient and what the file has of it
struct Coefficient {
  Coefficient(const Refinement& refinement, std::uint32_t coefficient)
      : place(coefficient),
        level(refinement.view->level[refinement.level[coefficient]]),
        column(coefficient - level.domain_begin),
        scale(level.scales_of<3>()[column]) {}
  std::uint32_t place;
  const LevelView& level;
  std::uint32_t column;
  const layout::Scale<3>& scale;
};

// what a force coefficient, times its scale, moves of those before it
std::uint64_t push_rows(const layout::Info& info, const Coefficient& from, Float4 force, const bool* moved, Float4* x) {
  std::uint64_t found = 0;
  for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
    const Splats<3> in_quanta = splats(without_denormals(scaled(block_factor<3>(info, layer), force)));
    with_stored<3>(layout::value_bits[layer], [&](auto stored) {
      found += visit_marked<decltype(stored)>(
          from.level.couplings[layer], from.column, moved,
          [&](std::uint32_t row, const Block<3>& block) { x[row] = components(x[row] + product(block, in_quanta)); });
    });
  }
  return found;
}

// what the force coefficients before it move of a coefficient
std::uint64_t pull_rows(const layout::Info& info, const Coefficient& to, const Float4* force, const bool* forced,
                        Float4* x) {
  Float4 sum = x[to.place];
  std::uint64_t found = 0;
  for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
    const float factor = block_factor<3>(info, layer);
    with_stored<3>(layout::value_bits[layer], [&](auto stored) {
      found += visit_marked<decltype(stored)>(
          to.level.couplings[layer], to.column, forced, [&](std::uint32_t row, const Block<3>& block) {
            sum = components(sum + transposed_product(block, without_denormals(scaled(factor, force[row]))));
          });
    });
  }
  x[to.place] = sum;
  return found;
}

}  // namespace

std::uint64_t couple_coefficients(const Refinement& refinement, const Touched& forced, Float4* force,
                                  const Touched& moved, Float4* x) noexcept {
  const layout::Info& info = *refinement.view->info;
  visit_coefficients(forced, [&](std::uint32_t place) {
    force[place] = symmetric_product(Coefficient(refinement, place).scale.root, force[place]);
  });
  std::uint64_t found = 0;
  visit_coefficients(forced, [&](std::uint32_t place) {
    found += push_rows(info, Coefficient(refinement, place), force[place], moved.mark, x);
  });
  visit_coefficients(moved, [&](std::uint32_t place) {
    const Coefficient to(refinement, place);
    found += pull_rows(info, to, force, forced.mark, x);
    const Float4 own = symmetric_product(to.scale.diagonal, without_denormals(force[place]));
    x[place] = symmetric_product(to.scale.root, added(x[place], own));
  });
  return found;
}

void displace_columns(const Refinement& refinement, const Touched& moved, Float4* x) noexcept {
  for (std::uint32_t level = 1; level <= moved.finest; ++level) {
    for (std::uint32_t q = 0; q < level; ++q) {
      for (std::uint32_t k = 0; k < moved.even[level][q]; ++k) {
        Float4& even = x[moved.list[q][k]];
        visit_neighbours(refinement, level, moved.list[q][k],
                         [&](std::uint32_t odd, float lift) { even = added(even, scaled(-lift, x[odd])); });
      }
    }
    for (std::uint32_t k = 0; k < moved.forced[level]; ++k) {
      Float4& odd = x[moved.list[level][k]];
      visit_prediction(refinement, moved.list[level][k], [&](std::uint32_t even, auto weight) {
        if constexpr (std::is_pointer_v<decltype(weight)>) {
          odd = added(odd, components(scaled(weight_unit<3>, product(StoredBlock<3, 16>::load(weight), x[even]))));
        } else {
          odd = added(odd, scaled(weight, x[even]));
        }
      });
    }
  }
}

}  // namespace greenloop
