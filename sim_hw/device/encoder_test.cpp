#include "sim_hw/device/encoder.hpp"

#include <doctest/doctest.h>

#include <cstdint>
#include <limits>
#include <random>

namespace greenloop {
namespace {

TEST_CASE("whole multiples of the resolution are counted exactly") {
  for (const int n : {-100000, -1, 0, 1, 77, 100000}) CHECK(encoder_counts(n * 1e-5, 1e-5) == n);
}

TEST_CASE("the nearest count is taken, halves go up") {
  CHECK(encoder_counts(0.25, 1) == 0);
  CHECK(encoder_counts(0.5, 1) == 1);
  CHECK(encoder_counts(-0.5, 1) == 0);
  CHECK(encoder_counts(-0.75, 1) == -1);
}

TEST_CASE("what comes back is within half a resolution") {
  constexpr std::uint64_t seed = 20031;
  INFO("seed ", seed);
  std::mt19937_64 random(seed);
  constexpr double resolution = 1e-5;
  for (int i = 0; i < 100000; ++i) {
    const double value = (static_cast<double>(random() >> 11) * 0x1p-53 - 0.5) * 0.4;
    const double back = encoder_value(encoder_counts(value, resolution), resolution);
    REQUIRE(std::abs(back - value) <= 0.5000001 * resolution);
  }
}

TEST_CASE("values beyond the counter stop at its ends") {
  CHECK(encoder_counts(1e30, 1) == INT32_MAX);
  CHECK(encoder_counts(-1e30, 1) == INT32_MIN);
  CHECK(encoder_counts(std::numeric_limits<double>::quiet_NaN(), 1) == INT32_MIN);
}

}  // namespace
}  // namespace greenloop
