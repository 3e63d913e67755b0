#include "offline/report/axis.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <random>

namespace greenloop::offline {

TEST_CASE("ticks of a linear axis are round and inside") {
  const auto ticks = linear_ticks(0, 10, 5);
  REQUIRE(ticks.size() == 6);
  CHECK(ticks[1] == doctest::Approx(2));
  CHECK(linear_ticks(-0.03, 0.07, 4) == std::vector<double>{0.0, 0.05});
  CHECK(linear_ticks(1, 1, 5).empty());
  CHECK(linear_ticks(0, std::numeric_limits<double>::infinity(), 5).empty());
}

TEST_CASE("ticks of random linear axes: few, inside, evenly spaced by 1, 2 or 5 times a power of ten") {
  std::mt19937_64 random(7);
  INFO("seed 7");
  for (int trial = 0; trial < 2000; ++trial) {
    const double min = std::ldexp(static_cast<double>(random()), -64) * 20 - 10;
    const double max = min + std::pow(10.0, static_cast<double>(random() % 12) - 6);
    const auto ticks = linear_ticks(min, max, 6);
    REQUIRE(ticks.size() >= 2);
    REQUIRE(ticks.size() <= 7);
    const double step = ticks[1] - ticks[0];
    const double leading = step / std::pow(10.0, std::floor(std::log10(step) + 1e-6));
    CHECK((std::abs(leading - 1) < 1e-4 || std::abs(leading - 2) < 1e-4 || std::abs(leading - 5) < 1e-4));
    CHECK(ticks.front() >= min - 1e-6 * step);
    CHECK(ticks.back() <= max + 1e-6 * step);
  }
}

TEST_CASE("ticks of a logarithmic axis are decades, or 1 2 5 when it is short") {
  const auto decades = logarithmic_ticks(0.002, 30);
  REQUIRE(decades.size() == 4);
  CHECK(decades[0] == doctest::Approx(0.01));
  CHECK(decades[3] == doctest::Approx(10));
  const auto dense = logarithmic_ticks(1.5, 12);
  REQUIRE(dense.size() == 3);
  CHECK(dense[0] == doctest::Approx(2));
  CHECK(dense[1] == doctest::Approx(5));
  CHECK(dense[2] == doctest::Approx(10));
  CHECK(logarithmic_ticks(0, 1).empty());
}

TEST_CASE("numbers read well") {
  CHECK(readable(0.012345, 3) == "0.0123");
  CHECK(readable(1500) == "1500");
  CHECK(readable(1234567, 9) == "1\u202f234\u202f567");
  CHECK(readable(-12345.5, 6) == "-12\u202f345.5");
  CHECK(readable(3e-7, 2) == "3e-07");
  CHECK(readable(std::nan("")) == "not a number");
  CHECK(readable_count(10096) == "10\u202f096");
  CHECK(readable_percent(0.0123) == "1.23\u202f%");
  CHECK(readable_bytes(1254321) == "1.25\u202fMB");
}

TEST_CASE("ranges between whose ends there are no numbers have no ticks, and none has more than asked for") {
  CHECK(linear_ticks(1e16, 1e16 + 2, 5).empty());
  CHECK(linear_ticks(-1e-320, 1e-320, 5).size() <= 6);
  CHECK(linear_ticks(-1.7e308, 1.7e308, 5).empty());
  for (const double size : {1e-300, 1e-12, 1.0, 1e12, 1e300}) {
    CHECK(linear_ticks(-size, size, 5).size() >= 3);
    CHECK(linear_ticks(-size, size, 5).size() <= 6);
  }
  CHECK(logarithmic_ticks(1e-300, 1e300).size() < 1000);
}

TEST_CASE("the SI prefix brings the largest value into 1..1000") {
  CHECK(si_prefix(0.0021).symbol == "m");
  CHECK(si_prefix(999).symbol == "");
  CHECK(si_prefix(12'000).symbol == "k");
  CHECK(si_prefix(0).factor == 1);
}

TEST_CASE("a scale maps its ends to its pixels") {
  const Scale linear{.min = 2, .max = 4, .from = 100, .to = 300};
  CHECK(linear(2) == doctest::Approx(100));
  CHECK(linear(3) == doctest::Approx(200));
  const Scale logarithmic{.min = 1, .max = 100, .from = 300, .to = 100, .logarithmic = true};
  CHECK(logarithmic(10) == doctest::Approx(200));
  const Scale counted{.min = -0.4, .max = 1.4, .whole = true};
  CHECK(counted.ticks(4) == std::vector<double>{0, 1});
}

}  // namespace greenloop::offline
