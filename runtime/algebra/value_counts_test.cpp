#include "runtime/algebra/value_counts.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <functional>
#include <numeric>
#include <random>
#include <vector>

namespace greenloop {
namespace {

template <std::uint32_t octaves>
void check(const std::vector<std::uint64_t>& values, std::uint64_t told_apart) {
  ValueCounts<octaves> counts;
  for (const std::uint64_t value : values) {
    counts.add(value);
  }
  std::vector<std::uint64_t> sorted = values;
  std::sort(sorted.begin(), sorted.end(), std::greater<>());
  std::uint64_t exact = 0;
  std::uint64_t most = 0;  // with the largest for all that are not told apart, and a 32nd
  for (std::size_t t = 0; t <= values.size(); ++t) {
    CHECK(counts.largest(t) >= exact);
    CHECK(counts.largest(t) <= most);
    if (t < values.size()) {
      exact += sorted[t];
      most += sorted[t] < told_apart ? sorted[t] + sorted[t] / 32 : sorted[0];
    }
  }
  CHECK(counts.most() == (values.empty() ? 0 : sorted[0]));
  CHECK(counts.largest(values.size() + 3) == counts.largest(values.size()));
}

TEST_CASE("the sum of the largest values is bounded within a 32nd") {
  std::mt19937_64 random(1);
  check<0>({}, 0);
  check<0>({0}, 63);
  check<16>({0xffffffffffffffff}, 0);
  for (const std::uint32_t bits : {3U, 6U, 11U, 21U, 22U, 40U}) {
    std::vector<std::uint64_t> values(200);
    std::generate(values.begin(), values.end(), [&] { return random() >> (64 - bits); });
    check<0>(values, 63);
    check<16>(values, std::uint64_t{63} << 16);
  }
  std::vector<std::uint64_t> all(5000);
  std::iota(all.begin(), all.end(), 0);
  check<16>(all, 5000);
}

}  // namespace
}  // namespace greenloop
