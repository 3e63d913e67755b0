#include "runtime/factor/factor_changes.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "runtime/testing/test_body.hpp"

namespace greenloop {
namespace {

// a window of the touchable nodes, pressed
std::vector<Constraint> window(const std::vector<std::uint32_t>& nodes, std::size_t first, std::size_t count) {
  std::vector<Constraint> contacts;
  for (std::size_t i = 0; i < count; ++i) {
    const auto u = static_cast<float>(1 + i % 5);
    contacts.push_back({nodes[(first + i) % nodes.size()], {1e-4F * u, -2e-4F, 5e-5F * u}});
  }
  return contacts;
}

// worst difference over the largest force
double difference(std::span<const float> a, std::span<const float> b, std::size_t count) {
  float worst = 0;
  float largest = 0;
  for (std::size_t i = 0; i < count; ++i) {
    worst = std::max(worst, std::abs(a[i] - b[i]));
    largest = std::max(largest, std::abs(b[i]));
  }
  return static_cast<double>(worst / largest);
}

TEST_CASE("a factor that follows a sliding contact holds it with the forces of a fresh one, for less work") {
  layout::Wavelet kind{};
  SUBCASE("lifted linear") { kind = layout::Wavelet::lifted_linear; }
  SUBCASE("equilibrated") { kind = layout::Wavelet::equilibrated; }
  const TestModel model({.levels = 5, .wavelet = kind, .touchable_above = 0.5});
  const auto nodes = model.touchable();
  for (const std::uint32_t factors : {1U, 3U}) {
    CAPTURE(factors);
    const Elastostatic::Limits limits{.max_contacts = 40, .cached_factors = factors};
    TestBody body(model, limits);
    TestBody fresh(model, {.max_contacts = 40, .cached_factors = 1});
    std::mt19937_64 random(5);
    std::size_t first = 0;
    int updates = 0;
    for (int step = 0; step < 200; ++step) {
      first += random() % 3;
      const auto contacts = window(nodes, first, 24 + random() % 12);
      const Elastostatic::StepReport report = body.step(contacts, any_budget);
      REQUIRE(report.status == Status::ok);
      fresh.step(window(nodes, first + nodes.size() / 2, 1), any_budget);  // of it nothing can be made
      const Elastostatic::StepReport expected = fresh.step(contacts, any_budget);
      REQUIRE(expected.details.changed_nodes == 0);
      CHECK(difference(body.force(), fresh.force(), 3 * contacts.size()) <= 2e-4);
      if (report.details.changed_nodes > 0) {
        ++updates;
        CHECK(report.work < expected.work);
        CHECK_FALSE(report.details.cached_factor);
      }
    }
    CHECK(updates > 150);
  }
}

TEST_CASE("what a factor changed into is cached, and what it came from as well") {
  const TestModel model({.levels = 4, .touchable_above = 0.2});
  const auto nodes = model.touchable();
  TestBody body(model, {.max_contacts = 30, .cached_factors = 2});
  const auto before = window(nodes, 0, 30);
  const auto after = window(nodes, 1, 30);
  CHECK(body.step(before, any_budget).details.changed_nodes == 0);
  CHECK(body.step(after, any_budget).details.changed_nodes == 2);
  CHECK(body.step(after, any_budget).details.cached_factor);
  CHECK(body.step(before, any_budget).details.cached_factor);
}

TEST_CASE("changes are what two sets differ by, and too many are none") {
  FactorCache cache;
  Arena counting;
  cache.carve<3>(counting, 2, 64);
  AlignedBytes memory(static_cast<std::size_t>(counting.bytes()));
  Arena arena(memory.data());
  cache.carve<3>(arena, 2, 64);
  std::vector<std::uint32_t> columns = {3, 5, 8, 13, 21};
  ColumnSet set{5, columns.data()};
  cache.keep(cache.make_room(set), set);
  std::vector<std::uint32_t> other = {1, 5, 8, 14, 21, 30};
  set = {6, other.data()};
  FactorChanges changes;
  find_changes(cache, set, changes);
  REQUIRE(changes.base != nullptr);
  REQUIRE(changes.added == 3);
  REQUIRE(changes.removed == 2);
  CHECK(std::vector(changes.in, changes.in + 3) == std::vector<std::uint32_t>{1, 14, 30});
  CHECK(std::vector(changes.out, changes.out + 2) == std::vector<std::uint32_t>{3, 13});
  std::vector<std::uint32_t> far(FactorChanges::most + 1);
  for (std::uint32_t i = 0; i < far.size(); ++i) {
    far[i] = 100 + i;
  }
  set = {static_cast<std::uint32_t>(far.size()), far.data()};
  find_changes(cache, set, changes);
  CHECK(changes.base == nullptr);
}

}  // namespace
}  // namespace greenloop
