#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "rt_tests/bench/median.hpp"
#include "runtime/hosted/thread_clock.hpp"

namespace greenloop::bench {

/// Thread CPU time since it was made, without what reading the clock takes, on some machines more than what is timed.
class ThreadTimer {
 public:
  [[nodiscard]] double us() const { return std::max(0.0, 1e-3 * static_cast<double>(ticks()) - reading_us()); }

 private:
  [[nodiscard]] std::int64_t ticks() const { return thread_nanoseconds() - begun_; }

  static double reading_us() {
    static const double us = [] {
      std::vector<double> readings;
      for (int i = 0; i < 1001; ++i) readings.push_back(1e-3 * static_cast<double>(ThreadTimer().ticks()));
      return median(readings);
    }();
    return us;
  }

  std::int64_t begun_ = thread_nanoseconds();
};

}  // namespace greenloop::bench
