#include "runtime/compliance/column_bounds.hpp"

#include <algorithm>
#include <bit>

#include "runtime/algebra/value_counts.hpp"
#include "runtime/compliance/capacitance_work.hpp"
#include "runtime/compliance/column_reach.hpp"
#include "runtime/wavelet/domain.hpp"

namespace greenloop {
namespace {

void raise(std::uint32_t& bound, std::uint32_t value) { bound = std::max(bound, value); }

// the columns of a level, and what they are followed with
struct Columns {
  const ModelView& view;
  std::uint32_t level;
  const LiftingCounts* lifting;
  const Degrees& degrees;
};

// the places, from `first` on, of the columns of level c that touchable nodes are represented by
void mark_places(const ModelView& view, std::uint32_t c, std::uint32_t first, Places& places) {
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    const LevelView& level = view.level[q];
    for (std::uint32_t i = 0; i < level.counts->node_count; ++i) {
      if ((level.nodes[i].flags & layout::node_touchable) != 0) {
        places.add(domain_place(view, view.representatives[c][q][i]) - first);
      }
    }
  }
}

template <class Visit>
void visit_columns(const ModelView& view, std::uint32_t c, Visit visit) {
  for (std::uint32_t first = 0; first < domain_up_to(view, c); first += Places::most) {
    Places places;
    mark_places(view, c, first, places);
    for (std::uint32_t word = 0; word < Places::most / 64; ++word) {
      for (std::uint64_t bits = places.bits[word]; bits != 0; bits &= bits - 1) {
        visit(make_column(c, first + 64 * word + static_cast<std::uint32_t>(std::countr_zero(bits))));
      }
    }
  }
}

template <class Visit>
void visit_reaches(const Columns& columns, Places& reached, Visit visit) {
  ReachBatch batch;
  const auto finish = [&] {
    follow(columns.view, columns.lifting, columns.degrees, batch, reached);
    std::for_each(batch.reach, batch.reach + batch.count, visit);
    batch = {};
  };
  visit_columns(columns.view, columns.level, [&](std::uint32_t column) {
    batch.column[batch.count++] = column;
    if (batch.count == ReachBatch::most) {
      finish();
    }
  });
  finish();
}

void raise_each(const Columns& columns, const Reach& reach, ColumnBounds& bounds) {
  const std::uint64_t length = prediction_of(columns.view).length;
  std::uint64_t visits = 1;
  for (std::uint32_t q = 0; q <= columns.level; ++q) {
    raise(bounds.forced[q], reach.forced[q]);
    raise(bounds.even[q], reach.even[q]);
    visits += length * reach.forced[q] + neighbour_visits(columns.lifting[q], reach.even[q]);
  }
  bounds.all_coefficients = std::max<std::uint64_t>(bounds.all_coefficients, reach.all_coefficients());
  bounds.visits = std::max(bounds.visits, visits);
  ++bounds.columns;
}

// of a level, that all columns reach together
std::uint64_t count_reached(const Columns& columns, std::uint32_t q, const Places& reached) {
  const LevelView& level = columns.view.level[q];
  const bool listed = columns.lifting[q].most_neighbours == 0 || lists_neighbours(columns.view, q);
  return listed ? reached.count(level.domain_begin, domain_up_to(columns.view, q)) : level.counts->domain_count;
}

// apart, so that neither has the stack of the other

[[gnu::noinline]] void bound_touched(const Columns& columns, std::uint32_t set_columns, ColumnBounds& bounds) {
  ValueCounts<0> coefficients[layout::max_levels];
  Places reached;
  visit_reaches(columns, reached, [&](const Reach& reach) {
    raise_each(columns, reach, bounds);
    for (std::uint32_t q = 0; q <= columns.level; ++q) {
      coefficients[q].add(reach.coefficients[q]);
    }
  });
  for (std::uint32_t q = 0; q <= columns.level; ++q) {
    bounds.touched[q] = std::min(coefficients[q].largest(set_columns), count_reached(columns, q, reached));
  }
}

[[gnu::noinline]] void bound_meetings(const Columns& columns, std::uint32_t set_columns, ColumnBounds& bounds) {
  ValueCounts<> meetings;
  Places reached;
  visit_reaches(columns, reached, [&](const Reach& reach) {
    std::uint64_t sum = 0;
    for (std::uint32_t q = 0; q <= columns.level; ++q) {
      sum += most_meetings(reach.blocks[q], reach.all_coefficients(), bounds.touched[q]);
    }
    meetings.add(sum);
  });
  bounds.meetings = meetings.largest(set_columns);
}

}  // namespace

ColumnBounds bound_columns(const ModelView& view, std::uint32_t c, std::uint32_t set_columns,
                           const LiftingCounts* lifting) noexcept {
  Degrees degrees;
  fill_degrees(view, c, degrees);
  const Columns columns{view, c, lifting, degrees};
  ColumnBounds bounds;
  bound_touched(columns, set_columns, bounds);
  bound_meetings(columns, set_columns, bounds);
  return bounds;
}

}  // namespace greenloop
