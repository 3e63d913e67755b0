#include "runtime/testing/rooms.hpp"

#include <algorithm>

#include "runtime/wavelet/domain.hpp"
#include "runtime/wavelet/point_support.hpp"

namespace greenloop {

namespace {

// bound of the slots of so many columns, as a body has it
std::uint64_t most_slots(const ModelView& view, std::uint32_t set_columns) {
  LiftingCounts lifting[layout::max_levels] = {};
  for (std::uint32_t q = 1; q < view.levels; ++q) lifting[q] = count_lifting(view, q);
  std::uint64_t most = 0;
  for (std::uint32_t c = 0; c < view.levels; ++c) {
    const ReachBound reach = bound_reach(view, c, lifting);
    std::uint64_t of_column = 0;
    for (std::uint32_t q = 0; q <= c; ++q) {
      of_column += std::min(view.level[q].counts->domain_count, reach.coefficients[q]);
    }
    most = std::max(most, of_column);
  }
  return std::min<std::uint64_t>(set_columns * most, view.domain_count) + set_columns;
}

}  // namespace

template <unsigned N>
Rooms<N>::Rooms(const ModelView& of_model, std::uint32_t set_columns, bool keeps_capacitance)
    : view(of_model), stored(view.domain_count), index_of_place(view.domain_count, layout::none) {
  counts.cached_factors = 2;
  counts.keeps_capacitance = keeps_capacitance;
  counts.prediction = prediction_of(view);
  Arena counting;
  carve(counting, set_columns);
  memory_ = AlignedBytes(static_cast<std::size_t>(counting.bytes()));
  Arena arena(memory_.data());
  carve(arena, set_columns);
  tables_.fill(view);
  refinement = tables_.refinement(view, lifting);
  std::fill_n(capacitance.slot, view.domain_count, layout::none);
  list_costs();
  prepare_fields();
}

template <unsigned N>
void Rooms<N>::carve(Arena& arena, std::uint32_t set_columns) {
  tables_.carve(arena, view);
  offsets.carve(arena, view);
  base_maker_.carve(arena, view);
  mirrored_maker_.carve(arena, view, base_maker_.columns());
  const std::uint32_t tiles = tiles_of(view.domain_count);
  field_sums.of_blocks = arena.take_zeroed<Vector<N>>(std::uint64_t{BaseColumns::width} * tiles);
  field_sums.of_tiles = base_maker_.columns().tiles > 0 ? arena.take_zeroed<TileSums<N>>(tiles) : nullptr;
  force = arena.take_zeroed<Vector<N>>(view.domain_count);
  touched.carve(arena, view);
  const std::uint64_t slots = most_slots(view, set_columns);
  counts.capacitance_room = capacitance_room(slots, set_columns);
  capacitance.prices = &counts.prices;
  capacitance.carve(arena, view, {set_columns, slots * set_columns, slots, view.domain_count}, counts.prediction);
  cache.carve<N>(arena, counts.cached_factors, set_columns, counts.keeps_capacitance);
  factoring.carve<N>(arena, set_columns);
  job.carve<N>(arena, view, set_columns, counts.keeps_capacitance);
}

template <unsigned N>
void Rooms<N>::list_costs() {
  std::vector<std::uint32_t> degree(std::size_t{view.domain_count} * view.levels);
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    const LevelView& level = view.level[q];
    for (const CouplingsView& couplings : level.couplings) {
      for (std::uint32_t i = 0; i < level.counts->domain_count; ++i) {
        stored[level.domain_begin + i] += column_length(couplings, i);
      }
    }
    visit_degrees(view, q, view.domain_count, [&](std::uint32_t coefficient, std::uint32_t with) {
      ++degree[std::size_t{view.levels} * coefficient + with];
    });
  }
  for (std::uint32_t c = 0; c < view.levels; ++c) {
    column_blocks_[c].resize(std::size_t{c + 1} * domain_up_to(view, c));
    for (std::uint32_t place = 0; place < domain_up_to(view, c); ++place) {
      costs_[c].push_back(column_cost(refinement, make_column(c, place), degree.data(), touched,
                                      column_blocks_[c].data() + std::size_t{c + 1} * place));
    }
    cost.level[c] = costs_[c].data();
    cost.blocks[c] = column_blocks_[c].data();
  }
}

template <unsigned N>
void Rooms<N>::prepare_fields() {
  offsets.fill(view);
  std::vector<std::uint8_t> read(view.domain_count);
  mark_read(refinement, touched, read.data());
  base = base_maker_.make(view);
  mirrored = mirrored_maker_.make(view, base, read.data());
  up_to_.resize(std::size_t{view.domain_count} * view.levels);
  count_field_blocks<N>(view, mirrored, base, up_to_.data());
  field_blocks = {view.levels, up_to_.data()};
}

template <unsigned N>
SetCounts Rooms<N>::touch_set(ColumnSet set) {
  clear(touched);
  touch(refinement, set.column, set.count, touched);
  SetCounts result;
  result.contacts = result.columns = set.count;
  count_factor(set, touched, cost, stored.data(), result);
  return result;
}

template class Rooms<1>;
template class Rooms<3>;

std::vector<std::uint32_t> columns_at(std::uint32_t c, std::vector<std::uint32_t> places) {
  std::sort(places.begin(), places.end());
  for (std::uint32_t& place : places) place = make_column(c, place);
  return places;
}

}  // namespace greenloop
