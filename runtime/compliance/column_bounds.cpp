#include "runtime/compliance/column_bounds.hpp"

#include <algorithm>
#include <bit>

#include "runtime/algebra/value_counts.hpp"
#include "runtime/compliance/capacitance_work.hpp"
#include "runtime/compliance/couplings.hpp"
#include "runtime/wavelet/domain.hpp"
#include "runtime/wavelet/point_support.hpp"

namespace greenloop {
namespace {

void raise(std::uint32_t& bound, std::uint32_t value) { bound = std::max(bound, value); }

// bounds of the blocks that coefficients have with those of levels 0..c
struct Degrees {
  static constexpr std::uint32_t exact = 640;
  static constexpr std::uint32_t sums = 9;
  std::uint32_t first[exact] = {};
  std::uint64_t most[layout::max_levels] = {};           // of a level that is not all among the first
  std::uint64_t largest[layout::max_levels][sums] = {};  // [.][k] of the 2^k largest of a lifted level together

  [[nodiscard]] std::uint64_t of(std::uint32_t level, std::uint32_t place) const {
    return place < exact ? first[place] : most[level];
  }
  // of some coefficients of a lifted level, who knows which: on average no more than fewer of the largest have
  [[nodiscard]] std::uint64_t of_some(std::uint32_t level, std::uint32_t count) const {
    const auto octave = static_cast<std::uint32_t>(std::bit_width(count | 1)) - 1;
    const std::uint32_t k = std::min(octave, sums - 1);
    return (largest[level][k] * count >> k) + 1;
  }
};

[[gnu::noinline]] void count_level(const ModelView& view, std::uint32_t q, std::uint32_t c, Degrees& degrees) {
  ValueCounts<> blocks;
  count_blocks(view, q, c, {}, blocks);
  degrees.most[q] = blocks.most();
  for (std::uint32_t k = 0; k < Degrees::sums; ++k) {
    degrees.largest[q][k] = blocks.largest(std::uint64_t{1} << k);
  }
}

void fill_degrees(const ModelView& view, std::uint32_t c, const LiftingCounts* lifting, Degrees& degrees) {
  for (std::uint32_t q = 0; q <= c; ++q) {
    add_degrees(view, q, std::min(view.domain_count, Degrees::exact), degrees.first);
    if (domain_up_to(view, q) > Degrees::exact || lifting[q].most_neighbours > 0) {
      count_level(view, q, c, degrees);
    }
  }
}

// some places among a few thousand
struct Places {
  static constexpr std::uint32_t most = 4096;
  std::uint64_t bits[most / 64] = {};

  void add(std::uint32_t place) {
    if (place < most) {
      bits[place / 64] |= std::uint64_t{1} << place % 64;
    }
  }
  // those in first .. end-1, and all that are beyond
  [[nodiscard]] std::uint64_t count(std::uint32_t first, std::uint32_t end) const {
    std::uint64_t sum = 0;
    for (std::uint32_t place = first; place < end; ++place) {
      sum += place < most ? bits[place / 64] >> place % 64 & 1 : 1;
    }
    return sum;
  }
};

// what one column reaches
struct Reach {
  std::uint32_t coefficients[layout::max_levels] = {};
  std::uint32_t forced[layout::max_levels] = {};
  std::uint32_t even[layout::max_levels] = {};
  std::uint64_t blocks = 0;
};

// nodes of M(level) in a support, by what lifts them
struct OddNodes {
  std::uint32_t count = 0;
  std::uint32_t alone = 0;  // lifted into no node: nobody's neighbours
  std::uint32_t twice = 0;  // lifted into two, neighbours of both
};

OddNodes count_odd_nodes(const ModelView& view, std::uint32_t level, const PointSupport& support) {
  const LevelView& at = view.level[level];
  OddNodes odd;
  for (std::uint32_t k = 0; k < support.count(); ++k) {
    if (support.node(k) < at.node_begin) {
      continue;
    }
    const std::uint32_t i = support.node(k) - at.node_begin;
    const float* lift = at.refinement[i].lift;
    ++odd.count;
    odd.alone += lift[0] == 0 && lift[1] == 0 ? 1 : 0;
    odd.twice += lift[0] != 0 && lift[1] != 0 ? 1 : 0;
  }
  return odd;
}

// the coefficients of the nodes of M(level) in a support
void add_coefficients(const ModelView& view, std::uint32_t level, const PointSupport& support, const Degrees& degrees,
                      Places& reached, Reach& reach) {
  for (std::uint32_t k = 0; k < support.count(); ++k) {
    if (support.node(k) >= view.level[level].node_begin) {
      const std::uint32_t place = domain_place(view, level, support.node(k));
      ++reach.coefficients[level];
      reach.blocks += degrees.of(level, place);
      reached.add(place);
    }
  }
}

[[gnu::noinline]] Reach reach_of(const ModelView& view, std::uint32_t column, const LiftingCounts* lifting,
                                 const Degrees& degrees, Places& reached) {
  PointSupport supports[2] = {PointSupport(most_support(view)), PointSupport(most_support(view))};
  PointSupport* support = supports;
  PointSupport* coarse = supports + 1;
  Reach reach;
  support->add(domain_node(view, column_place(column)));
  for (std::uint32_t level = column_level(column); level > 0; --level) {
    const OddNodes odd = count_odd_nodes(view, level, *support);
    static_cast<void>(coarsen(view, level, *support, *coarse));
    reach.forced[level] = odd.count;
    reach.even[level] = coarse->count();
    if (lifting[level].most_neighbours == 0) {
      add_coefficients(view, level, *support, degrees, reached, reach);
    } else {
      const std::uint32_t neighbours = coarse->count() * lifting[level].most_neighbours - odd.twice + odd.alone;
      reach.coefficients[level] = std::min(view.level[level].counts->domain_count, neighbours);
      reach.blocks += degrees.of_some(level, reach.coefficients[level]);
    }
    std::swap(support, coarse);
  }
  add_coefficients(view, 0, *support, degrees, reached, reach);
  return reach;
}

// what the columns of a level reach
struct AllReach {
  const ModelView& view;
  const LiftingCounts* lifting;
  std::uint32_t length;  // of a prediction
  ColumnBounds bounds;
  ValueCounts<0> coefficients[layout::max_levels];
  ValueCounts<> blocks;
  Places reached;

  void add(const Reach& reach) {
    std::uint64_t sum = 0;
    std::uint64_t visits = 1;
    for (std::uint32_t q = 0; q < view.levels; ++q) {
      raise(bounds.forced[q], reach.forced[q]);
      raise(bounds.even[q], reach.even[q]);
      coefficients[q].add(reach.coefficients[q]);
      sum += reach.coefficients[q];
      visits += std::uint64_t{length} * reach.forced[q] + neighbour_visits(lifting[q], reach.even[q]);
    }
    bounds.all_coefficients = std::max(bounds.all_coefficients, sum);
    bounds.visits = std::max(bounds.visits, visits);
    blocks.add(reach.blocks);
    ++bounds.columns;
  }
  void sum_up(std::uint32_t set_columns) {
    for (std::uint32_t q = 0; q < view.levels; ++q) {
      bounds.coefficients[q] = coefficients[q].largest(set_columns);
      const LevelView& level = view.level[q];
      bounds.reached[q] = lifting[q].most_neighbours == 0 ? reached.count(level.domain_begin, domain_up_to(view, q))
                                                          : level.counts->domain_count;
    }
    bounds.blocks = blocks.largest(set_columns);
  }
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

// apart, so that the degrees have a frame of their own
[[gnu::noinline]] ColumnBounds bound_with(const ModelView& view, std::uint32_t c, std::uint32_t set_columns,
                                          const LiftingCounts* lifting, const Degrees& degrees) {
  AllReach all{view, lifting, prediction_of(view).length, {}, {}, {}, {}};
  visit_columns(view, c, [&](std::uint32_t column) { all.add(reach_of(view, column, lifting, degrees, all.reached)); });
  all.sum_up(set_columns);
  return all.bounds;
}

}  // namespace

ColumnBounds bound_columns(const ModelView& view, std::uint32_t c, std::uint32_t set_columns,
                           const LiftingCounts* lifting) noexcept {
  Degrees degrees;
  fill_degrees(view, c, lifting, degrees);
  return bound_with(view, c, set_columns, lifting, degrees);
}

}  // namespace greenloop
