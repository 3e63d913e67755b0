#include <doctest/doctest.h>

#include "rt_tests/stress/stress_run.hpp"
#include "runtime/testing/test_body.hpp"

namespace greenloop {
namespace {

StressResult stress(const SyntheticOptions& synthetic, const StressOptions& options) {
  const TestModel model(synthetic);
  return run_stress(model.model(), options);
}

TEST_CASE("no script makes a body spend more than declared, answer garbage, allocate, lock or enter the kernel") {
  const SyntheticOptions models[] = {{.levels = 1},
                                     {.levels = 3, .epsilon = 0, .quantum = 0},
                                     {.levels = 4},
                                     {.levels = 4, .coarsest_constraint_level = 2, .touchable_above = 0.6},
                                     {.levels = 5, .field_threshold = 0.01, .touchable_above = 0.5},
                                     {.levels = 4, .wavelet = layout::Wavelet::lifted_butterfly},
                                     {.levels = 4, .wavelet = layout::Wavelet::butterfly, .field_threshold = 0.01}};
  const Limits limits[] = {{.max_contacts = 1, .cached_factors = 1},
                           {.max_contacts = 16, .cached_factors = 3},
                           {.max_contacts = 33, .cached_factors = 8}};
  std::uint64_t seed = 0;
  for (const auto& synthetic : models) {
    for (const auto& limit : limits) {
      ++seed;
      CAPTURE(synthetic.levels);
      CAPTURE(limit.max_contacts);
      CAPTURE(seed);
      const StressResult result = stress(synthetic, {.cycles = 1000, .seed = seed, .limits = limit});
      CHECK(result.work_overruns == 0);
      CHECK(result.wrong_answers == 0);
      CHECK(result.allocations == 0);
      CHECK(result.locks == 0);
      CHECK(result.system_calls <= 0);
      CHECK(result.minor_faults == 0);
      CHECK(result.answered > 600);
      CHECK(result.refused > 30);
      CHECK(result.worst_work > result.declared_work / 8);
      CHECK(result.passed());
    }
  }
}

TEST_CASE("the same seed gives the same digest, another seed another") {
  const StressOptions options{.cycles = 1000, .seed = 3, .limits = {.max_contacts = 8, .cached_factors = 2}};
  StressOptions other = options;
  other.seed = 4;
  const std::uint64_t digest = stress({.levels = 3}, options).digest;
  CHECK(stress({.levels = 3}, options).digest == digest);
  CHECK(stress({.levels = 3}, other).digest != digest);
}

TEST_CASE("every fault is seen") {
  for (const InjectedFault fault :
       {InjectedFault::allocation, InjectedFault::lock, InjectedFault::system_call, InjectedFault::overrun}) {
    const StressResult result = stress({.levels = 2}, {.cycles = 300, .limits = {.max_contacts = 4}, .fault = fault});
    CAPTURE(static_cast<int>(fault));
    CHECK((fault == InjectedFault::allocation) == (result.allocations > 0));
    CHECK((fault == InjectedFault::lock) == (result.locks > 0));
#ifdef __SANITIZE_ADDRESS__
    constexpr bool allocation_enters_kernel = true;  // the sanitizer's own allocator does
#else
    constexpr bool allocation_enters_kernel = false;
#endif
    if (fault != InjectedFault::allocation || !allocation_enters_kernel) {
      CHECK((fault == InjectedFault::system_call && result.system_calls >= 0) == (result.system_calls > 0));
    }
    CHECK((fault == InjectedFault::overrun) == (result.work_overruns > 0));
    CHECK(result.passed() == (fault == InjectedFault::system_call && result.system_calls < 0));
  }
}

}  // namespace
}  // namespace greenloop
