#include "runtime/factor/factor_job.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "runtime/algebra/cholesky.hpp"
#include "runtime/testing/rooms.hpp"
#include "runtime/testing/test_body.hpp"
#include "runtime/wavelet/domain.hpp"

namespace greenloop {
namespace {

// worst difference over the largest force
double difference(std::span<const float> a, std::span<const float> b) {
  double worst = 0;
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    worst = std::max(worst, std::abs(double{a[i]} - b[i]));
    largest = std::max(largest, std::abs(double{b[i]}));
  }
  return worst / largest;
}

// touchable nodes as columns of the finest level, from the `first` on
std::vector<std::uint32_t> patch_columns(const TestModel& model, std::size_t first, std::size_t count) {
  std::vector<std::uint32_t> places;
  for (const Constraint& contact : patch(model, first, count)) {
    places.push_back(domain_place(model.view(), contact.node));
  }
  return columns_at(model.view().levels - 1, places);
}

// work of the largest piece that a slice can be cut into
template <unsigned N>
std::uint64_t largest_piece(const Rooms<N>& rooms, const SetCounts& whole) {
  std::uint64_t longest = 0;
  for (std::uint32_t q = 0; q < rooms.view.levels; ++q) {
    for (std::uint32_t layer = 0; layer < layout::layers; ++layer) {
      for (std::uint32_t j = 0; j < rooms.view.level[q].counts->domain_count; ++j) {
        longest = std::max(longest, std::uint64_t{column_length(rooms.view.level[q].couplings[layer], j)});
      }
    }
  }
  const Prediction& prediction = rooms.counts.prediction;
  const Prices& prices = rooms.counts.prices;
  const std::uint64_t blocks = priced(longest, prices.stored_block) + priced(longest, prices.scaled_block) +
                               priced(2 * longest * whole.columns, meeting_price(prices, prediction));
  const std::uint64_t pair = panel_pair_work(prices, prediction, whole.visits, whole.columns);
  return std::max(
      {blocks, pair, begin_batch_work(rooms.counts, whole, 0), enter_work(rooms.counts, whole, whole.columns)});
}

// solution of the set's matrix for a right-hand side of ones, in the order of the set
template <unsigned N>
std::vector<float> solve_ones(const Rooms<N>& rooms, const Factor& factor, std::uint32_t columns) {
  const std::uint32_t order = N * columns;
  std::vector<Float4> b(padded_order(order) / 4);
  auto* x = reinterpret_cast<float*>(b.data());
  std::fill_n(x, order, 1.0F);
  cholesky_solve(order, rooms.cache.stride(), factor.matrix, b.data());
  std::vector<float> solution;
  for (std::uint32_t k = 0; k < columns; ++k) {
    const float* at = x + std::size_t{N} * factor.position[k];
    solution.insert(solution.end(), at, at + N);
  }
  return solution;
}

TEST_CASE_TEMPLATE("a factor is complete after as many slices as its work holds, each within its allowance", Components,
                   One, Three) {
  constexpr unsigned N = Components::value;
  layout::Wavelet kind{};
  SUBCASE("lifted linear") { kind = layout::Wavelet::lifted_linear; }
  SUBCASE("equilibrated") { kind = layout::Wavelet::equilibrated; }
  const TestModel model({.components = N, .levels = 5, .wavelet = kind, .touchable_above = 0.3});
  const std::vector<std::uint32_t> columns = patch_columns(model, 7, 40);
  const ColumnSet set{40, columns.data()};
  Rooms<N> fresh(model.view(), 40);
  fresh.touch_set(set);
  const Factor* const expected = make_factor<N>(fresh.factor_tools(), set, fresh.touched, nullptr);
  REQUIRE(expected != nullptr);
  const std::vector<float> right = solve_ones<N>(fresh, *expected, 40);
  for (const std::uint64_t part : {1U, 5U, 25U, 200U}) {
    Rooms<N> rooms(model.view(), 40);
    const SetCounts whole = rooms.touch_set(set);
    const std::uint64_t all = pending_work(rooms.counts, whole);
    const std::uint64_t compare = compare_factors_work(rooms.counts, 40) + 2 * whole.coefficients;
    const std::uint64_t piece = largest_piece<N>(rooms, whole);
    const std::uint64_t allowance = compare + piece + all / part;
    std::vector<FactorProgress> slices;
    do {
      slices.push_back(continue_factor<N>(rooms.job, rooms.factor_tools(), set, whole, {allowance}));
      REQUIRE(slices.back().work <= allowance);
      CHECK((slices.back().pending == 0 || slices.back().work + piece > allowance - compare));
    } while (slices.back().pending > 0 && slices.size() < 1000);
    // what is said to be pending holds what follows
    std::uint64_t follows = 0;
    for (auto slice = slices.rbegin(); slice != slices.rend(); ++slice) {
      CHECK(slice->pending >= follows);
      follows += slice->work - compare_factors_work(rooms.counts, 40);
    }
    CHECK(follows <= all);
    CHECK(all <= 2 * follows);
    MESSAGE("allowance ", allowance, " of ", all, " units: ", slices.size(), " slices, ", follows, " units");
    CHECK(slices.size() <= (all + allowance - compare - piece - 1) / (allowance - compare - piece));
    const Factor* const factor = rooms.cache.find(set);
    REQUIRE(factor != nullptr);
    CHECK(difference(solve_ones<N>(rooms, *factor, 40), right) <= 2e-4);
  }
}

TEST_CASE_TEMPLATE("less than a piece makes no progress, and says so", Components, One, Three) {
  constexpr unsigned N = Components::value;
  const TestModel model({.components = N, .levels = 4});
  const std::vector<std::uint32_t> columns = patch_columns(model, 0, 12);
  const ColumnSet set{12, columns.data()};
  Rooms<N> rooms(model.view(), 12);
  const SetCounts whole = rooms.touch_set(set);
  const std::uint64_t begin =
      compare_factors_work(rooms.counts, whole.columns) + begin_batch_work(rooms.counts, whole, 0);
  for (const std::uint64_t allowance : {std::uint64_t{0}, std::uint64_t{100}, begin - 1}) {
    const FactorProgress progress = continue_factor<N>(rooms.job, rooms.factor_tools(), set, whole, {allowance});
    CHECK(progress.work <= allowance);
    CHECK(progress.pending == pending_work(rooms.counts, whole));
  }
  CHECK(continue_factor<N>(rooms.job, rooms.factor_tools(), set, whole, {begin}).pending <
        pending_work(rooms.counts, whole));
}

TEST_CASE_TEMPLATE("a factor in the making follows its contacts, and begins anew for others", Components, One, Three) {
  constexpr unsigned N = Components::value;
  const TestModel model({.components = N, .levels = 5, .touchable_above = 0.3});
  const std::vector<std::uint32_t> before = patch_columns(model, 0, 40);
  const std::vector<std::uint32_t> after = patch_columns(model, 2, 40);
  const std::vector<std::uint32_t> elsewhere = patch_columns(model, 200, 40);
  Rooms<N> rooms(model.view(), 40);
  ColumnSet set{40, before.data()};
  SetCounts whole = rooms.touch_set(set);
  const std::uint64_t allowance = pending_work(rooms.counts, whole) / 20 + largest_piece<N>(rooms, whole);
  for (std::uint32_t slice = 0; slice < 20 && rooms.job.factor.columns < 20; ++slice) {
    continue_factor<N>(rooms.job, rooms.factor_tools(), set, whole, {allowance});
  }
  REQUIRE(rooms.job.factor.columns >= 20);
  const std::uint32_t made = rooms.job.factor.columns;
  set.column = after.data();
  whole = rooms.touch_set(set);
  std::uint32_t slices = 0;
  while (continue_factor<N>(rooms.job, rooms.factor_tools(), set, whole, {allowance}).pending > 0) {
    REQUIRE(++slices < 20);
    CHECK(rooms.job.factor.columns + 2 >= made);
  }
  CHECK(rooms.cache.find(set) != nullptr);
  set.column = elsewhere.data();
  whole = rooms.touch_set(set);
  CHECK(continue_factor<N>(rooms.job, rooms.factor_tools(), set, whole, {allowance}).pending >
        pending_work(rooms.counts, whole) / 2);
  set.column = after.data();
  whole = rooms.touch_set(set);
  drop_batch<N>(rooms.job, rooms.capacitance);
  CHECK(rooms.cache.find(set) != nullptr);
}

TEST_CASE("a matrix that is not positive definite is given up until the contacts change") {
  const SyntheticOptions options{.levels = 4};
  const Elastostatic::Limits limits{.max_contacts = 24, .cached_factors = 2};
  const TestModel definite(options);
  const std::size_t first = definite.touchable().size() - 30;
  const std::uint64_t budget = TestBody(definite, limits).step(patch(definite, first, 24), any_budget).work / 4;
  const TestModel model(encode(indefinite_model(options)));
  TestBody body(model, limits);
  const auto singular = patch(model, first, 24);
  Elastostatic::StepReport report = body.step(singular, budget);
  CHECK(report.details.pending_work > 0);
  for (std::uint32_t step = 0; step < 40 && report.details.pending_work > 0; ++step) {
    report = body.step(singular, budget);
    REQUIRE(report.status == Status::coarser);
    CHECK(report.work <= budget);
  }
  CHECK(report.details.pending_work == 0);
  const std::uint64_t held = report.work;
  for (std::uint32_t step = 0; step < 40; ++step) {
    report = body.step(singular, budget);
    CHECK(report.status == Status::coarser);
    CHECK(report.details.pending_work == 0);
  }
  CHECK(report.work <= held);
  CHECK(body.step(patch(model, 0, 24), budget).details.pending_work > 0);
}

TEST_CASE("no script of budgets and contacts exceeds a budget or the worst work, and it gives the same bits again") {
  const TestModel model({.levels = 4, .touchable_above = 0.2});
  const std::uint32_t finest = model.view().levels - 1;
  for (const Elastostatic::Limits& limits :
       {Elastostatic::Limits{.max_contacts = 1, .cached_factors = 1}, Elastostatic::Limits{.max_contacts = 20},
        Elastostatic::Limits{.max_contacts = 20, .refining_work = 200'000},
        Elastostatic::Limits{.max_contacts = 20, .cached_factors = 1, .forces_only = true}}) {
    CAPTURE(limits.max_contacts);
    const std::uint64_t whole =
        TestBody(model, limits).step(patch(model, 0, limits.max_contacts), any_budget, false).work;
    std::uint64_t digest[2] = {empty_hash, empty_hash};
    for (std::uint64_t& of_run : digest) {
      TestBody body(model, limits);
      const Elastostatic::Requirement& need = body.requirement();
      std::mt19937_64 random(17);
      std::uint32_t pending = 0;
      std::uint32_t refined = 0;
      Elastostatic::StepReport last;
      std::vector<Constraint> contacts;
      for (std::uint32_t step = 0; step < 1500; ++step) {
        if (step % (1 + random() % 24) == 0 || contacts.empty()) {
          contacts = patch(model, random() % 40, 1 + random() % limits.max_contacts);
        }
        const std::uint64_t budget = need.least_work + random() % (random() % 8 == 0 ? 4 * whole : whole / 8 + 1);
        const bool with_field = !limits.forces_only && random() % 2 == 0;
        const Elastostatic::StepReport report = body.step(contacts, budget, with_field);
        REQUIRE(answered(report.status));
        REQUIRE(report.work <= budget);
        REQUIRE(report.work <= need.worst_work[report.constraint_level]);
        const bool waits = report.details.waiting_contacts > 0;
        CHECK((report.constraint_level < finest || waits || report.details.pending_work == 0));
        pending += report.details.pending_work > 0 ? 1 : 0;
        refined += last.details.pending_work > 0 && report.constraint_level > last.constraint_level ? 1 : 0;
        last = report;
        of_run = hash_step(of_run, report, body.force(), {});
      }
      MESSAGE(limits.max_contacts, " contacts: ", pending, " steps with a pending factor, ", refined, " refined");
      if (limits.max_contacts > 1) {
        CHECK(pending > 50);
        CHECK(refined > 5);
      }
    }
    CHECK(digest[0] == digest[1]);
  }
}

TEST_CASE("held contacts reach the finest level on a budget that is too small for their factor") {
  const TestModel model({.levels = 5, .touchable_above = 0.3});
  const auto contacts = patch(model, 3, 32);
  for (const std::uint32_t factors : {1U, 2U, 4U}) {
    CAPTURE(factors);
    const Elastostatic::Limits limits{.max_contacts = 32, .cached_factors = factors};
    TestBody finest(model, limits);
    const Elastostatic::StepReport whole = finest.step(contacts, any_budget, false);
    REQUIRE(whole.status == Status::ok);
    const std::uint64_t fresh = least_budget_of_finest(model, limits, contacts, false);
    for (const std::uint64_t part : {2U, 4U, 8U, 16U}) {
      const std::uint64_t budget = fresh / part;
      TestBody body(model, limits);
      std::uint32_t steps = 0;
      std::uint64_t pending = 0;
      Elastostatic::StepReport report;
      do {
        report = body.step(contacts, budget, false);
        ++steps;
        REQUIRE(report.status == Status::coarser);
        REQUIRE(steps <= 40);
        CHECK(report.work <= budget);
        CHECK(report.work <= body.requirement().worst_work[report.constraint_level]);
        pending = report.constraint_level < 4 ? report.details.pending_work : pending;
      } while (report.constraint_level < 4);
      MESSAGE("finest level after ", steps, " steps of a ", part, "th of the work of a fresh factor");
      CHECK(pending == 0);
      CHECK(report.details.cached_factor);
      for (std::uint32_t step = 1; step < limits.glide_cycles; ++step) {
        report = body.step(contacts, budget, false);
        CHECK(report.constraint_level == 4);
      }
      CHECK(report.status == Status::ok);
      CHECK(difference(body.force(), finest.force()) <= 2e-4);
    }
  }
}

TEST_CASE("no more than the refining work of a step goes into a finer level") {
  const TestModel model({.levels = 5, .touchable_above = 0.3});
  const auto contacts = patch(model, 3, 32);
  const std::uint64_t whole = TestBody(model, {.max_contacts = 32}).step(contacts, any_budget).work;
  const auto steps_to_finest = [&](std::uint64_t refining_work) {
    TestBody body(model, {.max_contacts = 32, .refining_work = refining_work});
    std::uint32_t steps = 1;
    while (steps <= 100 && body.step(contacts, whole / 2).constraint_level < 4) {
      ++steps;
    }
    return steps;
  };
  const std::uint32_t unbounded = steps_to_finest(Elastostatic::Limits{}.refining_work);
  const std::uint32_t bounded = steps_to_finest(whole / 8);
  MESSAGE("finest level after ", unbounded, " steps; bounded, after ", bounded);
  CHECK(unbounded < bounded);
  CHECK(bounded <= 100);
  CHECK(steps_to_finest(1) == 101);
  const Elastostatic::Limits unbounded_limits{.max_contacts = 32};
  const Elastostatic::Requirement bounded_need =
      Elastostatic::required(model.model(), {.max_contacts = 32, .refining_work = 1});
  const Elastostatic::Requirement need = Elastostatic::required(model.model(), unbounded_limits);
  for (std::uint32_t c = 0; c < 4; ++c) {
    CHECK(bounded_need.worst_work[c] < need.worst_work[c]);
  }
  CHECK(bounded_need.worst_work[4] <= need.worst_work[4]);
}

TEST_CASE("a comparison with many factors keeps no contact from the finest level") {
  const TestModel model({.levels = 4});
  for (const std::uint32_t contacts : {1U, 3U}) {
    CAPTURE(contacts);
    TestBody body(model, {.max_contacts = 3, .cached_factors = 1024});
    const std::uint64_t budget = body.requirement().least_work;
    std::uint32_t steps = 0;
    while (body.step(patch(model, 5, contacts), budget, false).constraint_level < 3) {
      REQUIRE(++steps < 50);
    }
  }
}

TEST_CASE("a sliding contact reaches the finest level as well") {
  const TestModel model({.levels = 5, .touchable_above = 0.3});
  const Elastostatic::Limits limits{.max_contacts = 32, .cached_factors = 4};
  TestBody finest(model, limits);
  const std::uint64_t budget = finest.step(patch(model, 0, 32), any_budget).work / 4;
  TestBody body(model, limits);
  std::uint32_t reached = 0;
  for (std::uint32_t step = 0; step < 200; ++step) {
    const Elastostatic::StepReport report = body.step(patch(model, step / 8, 32), budget);
    REQUIRE(answered(report.status));
    CHECK(report.work <= budget);
    reached += report.constraint_level == 4 ? 1 : 0;
  }
  MESSAGE(reached, " of 200 steps at the finest level");
  CHECK(reached > 100);
}

// worst difference of C f from the displacements, over the largest: distinct columns, one compliance
double residual(TestBody& body, const std::vector<Constraint>& contacts) {
  double worst = 0, largest = 0;
  for (std::uint32_t i = 0; i < contacts.size(); ++i) {
    double sum[3] = {};
    for (std::uint32_t j = 0; j < contacts.size(); ++j) {
      float block[9];
      REQUIRE(body.body().compliance(i, j, block));
      for (std::size_t e = 0; e < 9; ++e) {
        sum[e % 3] += double{block[e]} * body.force()[3 * j + e / 3];
      }
    }
    for (std::size_t r = 0; r < 3; ++r) {
      worst = std::max(worst, std::abs(sum[r] - contacts[i].value[r]));
      largest = std::max(largest, std::abs(double{contacts[i].value[r]}));
    }
  }
  return worst / largest;
}

TEST_CASE("the capacitance that is kept is that of the answer, however its factor was made") {
  const TestModel model({.levels = 5, .touchable_above = 0.5});
  const Elastostatic::Limits limits{
      .max_contacts = 24, .cached_factors = 2, .keep_capacitance = true, .glide_cycles = 1};
  TestBody body(model, limits);
  const std::uint64_t fresh_work = body.step(patch(model, 0, 24), any_budget).work;
  CHECK(residual(body, patch(model, 0, 24)) < 1e-4);
  int updates = 0;
  for (std::size_t first = 1; first < 60; first += 1 + first % 3) {
    const auto contacts = patch(model, first, 16 + first % 9);
    updates += body.step(contacts, any_budget).details.changed_nodes > 0 ? 1 : 0;
    CHECK(residual(body, contacts) < 1e-4);
  }
  CHECK(updates > 20);
  // in slices
  TestBody slow(model, limits);
  const auto contacts = patch(model, 100, 24);
  Elastostatic::StepReport report;
  int steps = 0;
  do {
    report = slow.step(contacts, fresh_work / 2);
    REQUIRE(answered(report.status));
  } while (report.status != Status::ok && ++steps < 500);
  REQUIRE(report.status == Status::ok);
  CHECK(steps > 0);
  CHECK(residual(slow, contacts) < 1e-4);
}

TEST_CASE("there is no compliance where none is kept, nothing was answered or a place is out of range") {
  const TestModel model({.levels = 3});
  TestBody without(model, {.max_contacts = 4, .cached_factors = 1});
  TestBody with(model, {.max_contacts = 4, .cached_factors = 1, .keep_capacitance = true});
  float block[9] = {7};
  CHECK_FALSE(with.body().compliance(0, 0, block));
  const auto contacts = patch(model, 0, 4);
  without.step(contacts, any_budget);
  CHECK_FALSE(without.body().compliance(0, 0, block));
  with.step(contacts, any_budget);
  CHECK_FALSE(with.body().compliance(0, 4, block));
  CHECK(block[0] == 7);
  CHECK(with.body().compliance(0, 3, block));
  float transposed[9];
  CHECK(with.body().compliance(3, 0, transposed));
  CHECK(block[1] == transposed[3]);
  with.step(contacts, 0);  // refused
  CHECK_FALSE(with.body().compliance(0, 3, block));
  with.step(contacts, any_budget);
  CHECK(with.body().compliance(0, 3, block));
  with.step({}, any_budget);
  CHECK_FALSE(with.body().compliance(0, 0, block));
  CHECK(with.requirement().bytes > without.requirement().bytes);
}

}  // namespace
}  // namespace greenloop
