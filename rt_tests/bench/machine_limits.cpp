#include "rt_tests/bench/machine_limits.hpp"

#include <algorithm>

#include "rt_tests/harness/time_of.hpp"

namespace greenloop::bench {
namespace {

constexpr std::size_t chains = 8;  // sums at once, so that none waits for itself

}  // namespace

ReadStream::ReadStream(std::size_t bytes) : memory_(bytes / sizeof(Float4), splat(1.0F)) {}

double ReadStream::measure() {
  constexpr std::size_t least_bytes = 4 << 20;  // between two looks at the clock
  const std::size_t readings = std::max<std::size_t>(1, least_bytes / bytes());
  const double us = time_of(readings, [this] {
    Float4 sum[chains] = {};
    for (std::size_t i = 0; i < memory_.size(); i += chains) {
      for (std::size_t k = 0; k < chains; ++k) {
        sum[k] += memory_[i + k];
      }
    }
    Float4 total{};
    for (const Float4& chain : sum) {
      total += chain;
    }
    sum_ += total[0];
    asm volatile("" ::: "memory");
  });
  return static_cast<double>(bytes()) / us;
}

double measure_flops() {
  constexpr std::size_t turns = 20000;
  volatile float seed = 1.0F;
  const Float4 factor = splat(seed), term = splat(seed);
  volatile float sink = 0;
  const double us = time_of(1, [&] {
    Float4 x[chains] = {};
    for (std::size_t i = 0; i < turns; ++i) {
      for (Float4& chain : x) {
        chain = chain * factor + term;
      }
    }
    for (const Float4& chain : x) {
      sink = chain[0];
    }
  });
  return static_cast<double>(turns * chains * 4 * 2) / us;
}

}  // namespace greenloop::bench
