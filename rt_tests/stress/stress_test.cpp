#include <doctest/doctest.h>

#include <algorithm>
#include <set>
#include <utility>

#include "rt_tests/harness/loaded_driver.hpp"
#include "rt_tests/stress/stress_report.hpp"
#include "runtime/testing/test_body.hpp"

namespace greenloop {
namespace {

StressResult stress(const SyntheticOptions& synthetic, const StressOptions& options) {
  const TestModel model(synthetic);
  return run_stress<ElastostaticDriver>(model.model(), options);
}

const ScriptResult& result_of(const StressResult& result, ScriptKind kind) {
  return *std::find_if(result.scripts.begin(), result.scripts.end(), [kind](auto& s) { return s.kind == kind; });
}

double declared_over_worst(const StressResult& result) {
  return static_cast<double>(result.declared_work) / static_cast<double>(result.counts.worst_work);
}

constexpr double declared_bar = 1.25;

// as a processor without much cache may have them: what is done once a coefficient is dear, what a block takes is not
Prices dear_coefficients() {
  Prices prices;
  prices.slot = 1500 * 256;
  prices.coefficient = 1000 * 256;
  prices.pair_visit = 100 * 256;
  prices.pair_visit_by_blocks = 130 * 256;
  prices.scaled_block = 10 * 256;
  prices.meeting_by_blocks = 16 * 256;
  prices.functional_visit = 20 * 256;
  return prices;
}

TEST_CASE("no script makes a body spend more than declared, answer garbage, allocate, lock or enter the kernel") {
  const SyntheticOptions models[] = {{.levels = 1},
                                     {.levels = 3, .epsilon = 0, .quantum = 0},
                                     {.levels = 4},
                                     {.levels = 4, .coarsest_constraint_level = 2, .touchable_above = 0.6},
                                     {.levels = 5, .touchable_above = 0.5},
                                     {.levels = 4, .wavelet = layout::Wavelet::lifted_butterfly},
                                     {.levels = 4, .wavelet = layout::Wavelet::butterfly},
                                     {.levels = 4, .wavelet = layout::Wavelet::equilibrated},
                                     {.levels = 5, .wavelet = layout::Wavelet::equilibrated, .touchable_above = 0.5},
                                     {.levels = 5, .coarsest_constraint_level = 1, .wavelet = layout::Wavelet::linear}};
  constexpr std::pair<std::uint32_t, std::uint32_t> limits[] = {{1, 1}, {16, 3}, {33, 8}};
  std::uint64_t seed = 0;
  for (const auto& synthetic : models) {
    for (const auto& [contacts, factors] : limits) {
      ++seed;
      CAPTURE(synthetic.levels);
      CAPTURE(contacts);
      CAPTURE(seed);
      const StressResult result =
          stress(synthetic, {.cycles = 1400, .seed = seed, .contacts = contacts, .factors = factors});
      CHECK(result.violations.work_overruns == 0);
      CHECK(result.violations.wrong_answers == 0);
      CHECK(result.violations.allocations == 0);
      CHECK(result.violations.locks == 0);
      CHECK(result.violations.system_calls == 0);
      CHECK(result.violations.minor_faults == 0);
      MESSAGE("declared work over the most that a step spent: ", declared_over_worst(result));
      CHECK(declared_over_worst(result) <= declared_bar);
      CHECK(result.times.total() == result.cycles);
      CHECK(result.held());
    }
  }
}

TEST_CASE("nor does it with loads beside the contacts, and points that are asked for") {
  const SyntheticOptions models[] = {{.levels = 1, .gravity = true},
                                     {.levels = 4, .wavelet = layout::Wavelet::linear},
                                     {.levels = 4, .wavelet = layout::Wavelet::lifted_butterfly, .gravity = true},
                                     {.levels = 4, .coarsest_constraint_level = 2, .touchable_above = 0.6},
                                     {.levels = 4, .wavelet = layout::Wavelet::equilibrated, .gravity = true}};
  std::uint64_t seed = 40, coarser = 0;
  for (const auto& synthetic : models) {
    const TestModel model(synthetic);
    for (const std::uint32_t contacts : {1U, 16U, 33U}) {
      CAPTURE(++seed);
      CAPTURE(contacts);
      const StressResult result =
          run_stress<LoadedDriver>(model.model(), {.cycles = 1400, .seed = seed, .contacts = contacts, .factors = 3});
      CHECK(result.violations.work_overruns == 0);
      CHECK(result.violations.wrong_answers == 0);
      CHECK(result.violations.allocations == 0);
      CHECK(result.violations.system_calls == 0);
      CHECK(result.held());
      coarser += result.counts.of(Status::coarser);
    }
  }
  CHECK(coarser > 1000);
}

TEST_CASE("what is declared is near what the dearest sets take, at other prices too") {
  for (const layout::Wavelet wavelet : layout::wavelets) {
    const TestModel model({.levels = 4, .wavelet = wavelet});
    for (const std::uint32_t contacts : {4U, 16U, 64U}) {
      CAPTURE(static_cast<std::uint32_t>(wavelet));
      CAPTURE(contacts);
      const StressResult result = run_stress<ElastostaticDriver>(
          model.model(),
          {.cycles = 400, .script = ScriptKind::hunt, .contacts = contacts, .prices = dear_coefficients()});
      CHECK(result.held());
      MESSAGE("declared work over the most that a step spent: ", declared_over_worst(result));
      CHECK(declared_over_worst(result) <= declared_bar);
    }
  }
}

TEST_CASE("every script does what its name says") {
  const StressResult result = stress({.levels = 4}, {.cycles = 14003, .seed = 5, .contacts = 16, .factors = 3});
  REQUIRE(result.scripts.size() == contact_script_names.size());
  CHECK(result.cycles == 14003);
  std::set<std::uint64_t> digests;
  for (const ScriptResult& script : result.scripts) {
    CAPTURE(name(script.kind));
    CHECK(script.counts.answers() + script.counts.refusals() == script.cycles);
    CHECK(script.cycles >= 1000);
    CHECK(script.cycles <= 1001);
    CHECK((script.kind == ScriptKind::garbage) == (script.counts.answers() == 0));
    CHECK(script.counts.worst_work <= result.counts.worst_work);
    digests.insert(script.digest);
  }
  CHECK(digests.size() == contact_script_names.size());
  CHECK(result_of(result, ScriptKind::press).counts.cached > 500);
  CHECK(result_of(result, ScriptKind::slide).counts.changed > 100);
  CHECK(result_of(result, ScriptKind::neighbours).counts.cached > 500);
  CHECK(result_of(result, ScriptKind::random).counts.cached < 100);
  CHECK(result_of(result, ScriptKind::defeat_cache).counts.cached < 300);
  CHECK(result_of(result, ScriptKind::flap_levels).counts.of(Status::coarser) > 100);
  CHECK(result_of(result, ScriptKind::flap_levels).force_step_max > 0.01);
  CHECK(result_of(result, ScriptKind::press).force_step_max == 0);
  CHECK(result_of(result, ScriptKind::single).counts.worst_work <
        result_of(result, ScriptKind::every_node).counts.worst_work);
  CHECK(result_of(result, ScriptKind::hunt).counts.worst_work == result.counts.worst_work);
  for (const Status status : {Status::held_not_finite, Status::held_out_of_range, Status::held_not_touchable,
                              Status::held_duplicate, Status::held_over_budget}) {
    CHECK(result.counts.of(status) > 0);
  }
}

TEST_CASE("the same seed gives the same digest, another seed another") {
  const StressOptions options{.cycles = 1400, .seed = 3, .contacts = 8, .factors = 2};
  StressOptions other = options;
  other.seed = 4;
  const std::uint64_t digest = stress({.levels = 3}, options).digest;
  CHECK(stress({.levels = 3}, options).digest == digest);
  CHECK(stress({.levels = 3}, other).digest != digest);
}

TEST_CASE("a script alone does what it did among the others") {
  StressOptions options{.cycles = 2800, .seed = 9, .contacts = 8, .factors = 2};
  const TestModel model({.levels = 3});
  const StressResult all = run_stress<ElastostaticDriver>(model.model(), options);
  options.cycles = 200;
  for (const ScriptResult& among : all.scripts) {
    CAPTURE(name(among.kind));
    options.script = among.kind;
    const StressResult alone = run_stress<ElastostaticDriver>(model.model(), options);
    REQUIRE(alone.scripts.size() == 1);
    CHECK(alone.scripts[0].digest == among.digest);
    CHECK(alone.scripts[0].counts.worst_work == among.counts.worst_work);
  }
}

TEST_CASE("every fault is seen, counted and can be met again") {
  for (const InjectedFault fault : {InjectedFault::none, InjectedFault::allocation, InjectedFault::lock,
                                    InjectedFault::system_call, InjectedFault::page_fault, InjectedFault::overrun}) {
    StressReport report{
        .model = "m.gloop",
        .options = {.cycles = 300, .seed = 7, .script = ScriptKind::slide, .contacts = 4, .fault = fault}};
    report.result = stress({.levels = 2}, report.options);
    const StressResult& result = report.result;
    CAPTURE(static_cast<int>(fault));
    const Violations& seen = result.violations;
    CHECK((fault == InjectedFault::allocation) == (seen.allocations > 0));
    CHECK((fault == InjectedFault::lock) == (seen.locks > 0));
    CHECK((fault == InjectedFault::overrun) == (seen.work_overruns > 0));
    CHECK(seen.wrong_answers == 0);
#ifdef __SANITIZE_ADDRESS__
    constexpr bool allocation_enters_kernel = true;  // the sanitizer's own allocator does
#else
    constexpr bool allocation_enters_kernel = false;
#endif
    if (fault != InjectedFault::allocation || !allocation_enters_kernel) {
      CHECK((fault == InjectedFault::system_call && result.watches_system_calls) == (seen.system_calls > 0));
      CHECK((fault == InjectedFault::page_fault) == (seen.minor_faults > 0));
    }
    const bool unseen = fault == InjectedFault::system_call && !result.watches_system_calls;
    CHECK(result.held() == (fault == InjectedFault::none || unseen));
    CHECK(result.held() == (report.verdict() == "HELD"));
    REQUIRE(result.held() == !result.first_violation);
    if (!result.held()) {
      CHECK(result.first_violation->cycle == 99);
      CHECK(report.replay() ==
            "greenloop-stress m.gloop --seed 7 --script slide --cycles 100 --contacts 4 --factors 8");
      CHECK(report.json()["first_violation"]["script"] == "slide");
    }
  }
}

TEST_CASE("the histogram counts every time once") {
  TimeHistogram times(3);
  for (const double us : {0.0, 0.9, 1.0, 2.99, 3.0, 100.0}) {
    times.add(us);
  }
  CHECK(times.count() == std::vector<std::uint64_t>{2, 1, 1});
  CHECK(times.overflows() == 2);
  CHECK(times.total() == 6);
  CHECK(times.least() == 0);
  CHECK(times.most() == 100);
  CHECK(times.average() == doctest::Approx(107.89 / 6));
}

}  // namespace
}  // namespace greenloop
