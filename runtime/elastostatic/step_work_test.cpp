#include "runtime/elastostatic/step_work.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <random>
#include <set>

#include "runtime/elastostatic/planner.hpp"
#include "runtime/testing/rooms.hpp"
#include "runtime/testing/test_body.hpp"
#include "runtime/wavelet/domain.hpp"

namespace greenloop {
namespace {

// columns of level c that touchable nodes are represented by
std::vector<std::uint32_t> columns_of(const ModelView& view, std::uint32_t c) {
  std::set<std::uint32_t> columns;
  visit_nodes(view, [&](std::uint32_t node, const layout::NodeRecord& record) {
    if ((record.flags & layout::node_touchable) != 0) {
      const std::uint32_t q = level_of(view, node);
      columns.insert(make_column(c, domain_place(view, view.representatives[c][q][node - view.level[q].node_begin])));
    }
  });
  return {columns.begin(), columns.end()};
}

std::uint64_t fresh_work(const ModelCounts& model, const SetCounts& set, std::uint64_t blocks) {
  return plan_set_work(model, set) + factor_work(model, set) + force_work(model.prices, set) +
         field_work(model, set, {model.levels - 1, model.levels - 1}, blocks);
}

// any prices, the prediction's among them
Prices draw_prices(std::mt19937_64& random) {
  Prices prices;
  const auto draw = [&random] { return static_cast<std::uint32_t>(1 << random() % 16); };
#define GREENLOOP_ROW(name, x86_64, cortex_m7, what) prices.name = draw();
  GREENLOOP_PRICES(GREENLOOP_ROW)
#undef GREENLOOP_ROW
  return prices;
}

struct Limit {
  std::uint32_t contacts = 0;
  MostCounts of[layout::max_levels];
};

Limit limit_of(const Rooms<3>& rooms, std::uint32_t contacts) {
  const ModelView& view = rooms.view;
  LiftingCounts lifting[layout::max_levels] = {};
  for (std::uint32_t q = 1; q < view.levels; ++q) {
    lifting[q] = count_lifting(view, q);
  }
  Limit limit;
  limit.contacts = contacts;
  for (std::uint32_t c = view.info->coarsest_constraint_level; c < view.levels; ++c) {
    limit.of[c] = most_counts(view, c, contacts, bound_columns(view, c, contacts, lifting), lifting);
  }
  add_blocks(view, rooms.base, limit.of);
  return limit;
}

void check_set(Rooms<3>& rooms, const MostCounts& most, const std::vector<std::uint32_t>& columns,
               std::mt19937_64& random) {
  const ModelView& view = rooms.view;
  const std::uint32_t finest = view.levels - 1;
  const SetCounts set = rooms.touch_set({static_cast<std::uint32_t>(columns.size()), columns.data()});
  CHECK(set.columns <= most.set.columns);
  CHECK(set.coefficients <= most.set.coefficients);
  CHECK(set.visits <= most.set.visits);
  CHECK(set.slots <= most.set.slots);
  CHECK(set.stored <= most.set.stored);
  CHECK(set.column.visits <= most.set.column.visits);
  CHECK(set.column.coefficients <= most.set.column.coefficients);
  CHECK(set.column.meetings <= most.set.column.meetings);
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    CHECK(rooms.touched.count[q] <= most.touched[q]);
  }
  const std::uint64_t blocks = count_field_blocks(rooms.field_blocks, rooms.touched, finest);
  CHECK(blocks <= most.field_blocks);
  CHECK(count_field_blocks(rooms.field_blocks, rooms.touched, 0) <= most.least_field_blocks);
  ModelCounts model;
  static_cast<FactorCounts&>(model) = rooms.counts;
  model.levels = view.levels;
  for (std::uint32_t q = 0; q < view.levels; ++q) {
    model.nodes[q] = nodes_up_to(view, q);
    model.rows[q] = domain_up_to(view, q);
  }
  for (int drawn = 0; drawn < 4; ++drawn) {
    model.prices = drawn == 0 ? Prices{} : draw_prices(random);
    for (const std::uint64_t room : {model.capacitance_room, model.capacitance_room / 8, set.slots * set.slots}) {
      model.capacitance_room = room;
      CHECK(fresh_work(model, set, blocks) <= fresh_work(model, most.set, most.field_blocks));
    }
    model.capacitance_room = rooms.counts.capacitance_room;
  }
}

TEST_CASE("no set of contacts holds more than is declared, nor takes more work at any prices") {
  for (const layout::Wavelet kind : layout::wavelets) {
    for (const double touchable_above : {0.0, 0.7}) {
      CAPTURE(static_cast<std::uint32_t>(kind));
      const TestModel model({.levels = 4, .wavelet = kind, .touchable_above = touchable_above});
      Rooms<3> rooms(model.view(), 40);
      std::mt19937_64 random(5);
      for (const std::uint32_t contacts : {1U, 5U, 16U, 40U}) {
        const Limit limit = limit_of(rooms, contacts);
        for (std::uint32_t c = 0; c < model.view().levels; ++c) {
          std::vector<std::uint32_t> all = columns_of(model.view(), c);
          CHECK(limit.of[c].set.columns == std::min<std::size_t>(all.size(), contacts));
          for (int trial = 0; trial < 20; ++trial) {
            std::shuffle(all.begin(), all.end(), random);
            const std::size_t count = trial < 12 ? contacts : 1 + random() % contacts;
            std::vector<std::uint32_t> columns(all.begin(),
                                               all.begin() + static_cast<std::ptrdiff_t>(std::min(count, all.size())));
            std::sort(columns.begin(), columns.end());
            check_set(rooms, limit.of[c], columns, random);
          }
        }
      }
    }
  }
}

TEST_CASE("a budget of the finest level's declared work is never too small") {
  for (const std::uint32_t levels : {1U, 2U, 4U}) {
    for (const std::uint32_t contacts : {1U, 4U}) {
      CAPTURE(levels);
      CAPTURE(contacts);
      const TestModel model({.levels = levels});
      TestBody body(model, {.max_contacts = contacts});
      const std::uint64_t declared = body.requirement().worst_work[levels - 1];
      CHECK(body.requirement().least_work <= declared);
      CHECK(body.step(patch(model, 0, contacts), declared).constraint_level == levels - 1);
    }
  }
}

TEST_CASE("a body at rest takes what is declared at most, however dear its nodes are") {
  const TestModel model({.levels = 3});
  Elastostatic::Limits limits{.max_contacts = 4, .cached_factors = 2};
  const Elastostatic::Requirement usual = Elastostatic::required(model.model(), limits);
  limits.prices.resting_node = std::uint32_t{1} << 24;
  const Elastostatic::Requirement dear = Elastostatic::required(model.model(), limits);
  const std::uint64_t rest = rest_field_work(limits.prices, model.view().node_count);
  CHECK(rest > usual.worst_work[2]);
  CHECK(dear.least_work > rest);
  CHECK(dear.worst_work[2] > rest);
  limits.forces_only = true;
  CHECK(Elastostatic::required(model.model(), limits).least_work < usual.least_work);
}

}  // namespace
}  // namespace greenloop
