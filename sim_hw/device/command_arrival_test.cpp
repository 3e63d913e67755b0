#include "sim_hw/device/command_arrival.hpp"

#include <doctest/doctest.h>

#include <cstdint>
#include <initializer_list>

namespace greenloop {
namespace {

std::int64_t late_in(CommandArrival& arrival, std::int64_t cycles, std::int64_t work = 50, std::int64_t budget = 100) {
  for (std::int64_t k = 0; k < cycles && !arrival.must_stop(); ++k) (void)arrival.late(k, work, budget);
  return arrival.late_count();
}

TEST_CASE("without faults and within the budget nothing is late") {
  CommandArrival arrival;
  CHECK(late_in(arrival, 1000) == 0);
  CHECK(late_in(arrival, 1000, 100, 100) == 0);
}

TEST_CASE("a command that took more than its budget is late") {
  CommandArrival arrival;
  CHECK(arrival.late(0, 101, 100));
  CHECK_FALSE(arrival.late(1, 100, 100));
  CHECK(arrival.late_count() == 1);
}

TEST_CASE("a link that holds back for n cycles makes exactly n commands late") {
  for (const std::int64_t n : {1, 2, 19}) {
    CommandArrival arrival({.delay_from = 100, .delay_cycles = n});
    CHECK(late_in(arrival, 1000) == n);
    CHECK_FALSE(arrival.must_stop());
  }
}

TEST_CASE("the first and the last held-back command are the late ones") {
  const CommandArrival arrival({.delay_from = 100, .delay_cycles = 3});
  CHECK_FALSE(arrival.injected(99));
  CHECK(arrival.injected(100));
  CHECK(arrival.injected(102));
  CHECK_FALSE(arrival.injected(103));
}

TEST_CASE("losing every k-th of n commands makes floor(n / k) late") {
  for (const std::int64_t k : {2, 7, 1000}) {
    CommandArrival arrival({.loss_every = k});
    CHECK(late_in(arrival, 1000) == 1000 / k);
  }
}

TEST_CASE("twenty in a row stop the device, nineteen do not") {
  CommandArrival twenty({.delay_from = 10, .delay_cycles = 500});
  CHECK(late_in(twenty, 1000) == 20);
  CHECK(twenty.must_stop());
  CommandArrival interrupted({.delay_from = 10, .delay_cycles = 19});
  CHECK(late_in(interrupted, 1000) == 19);
  CHECK_FALSE(interrupted.must_stop());
}

TEST_CASE("a loss next to a delay lengthens the row") {
  CommandArrival arrival({.delay_from = 0, .delay_cycles = 19, .loss_every = 20});
  CHECK(late_in(arrival, 100) == 20);
  CHECK(arrival.must_stop());
}

}  // namespace
}  // namespace greenloop
