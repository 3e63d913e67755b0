#include "rt_tests/stress/time_output.hpp"

#include <fmt/format.h>

namespace greenloop {

nlohmann::json as_json(const TimeHistogram& times) {
  return {{"unit", "us"},           {"clock", "thread CPU time"},
          {"count", times.count()}, {"overflows", times.overflows()},
          {"total", times.total()}, {"min", times.least()},
          {"avg", times.average()}, {"max", times.most()}};
}

void print_histogram(const TimeHistogram& times) {
  fmt::print("# Histogram: microseconds of thread CPU time, steps (reading the clock is part of it)\n");
  for (std::size_t bin = 0; bin < times.count().size(); ++bin) {
    if (times.count()[bin] > 0) {
      fmt::print("{:06} {:06}\n", bin, times.count()[bin]);
    }
  }
  fmt::print("# Total: {:09}\n# Min Latencies: {:05.0f}\n# Avg Latencies: {:05.0f}\n# Max Latencies: {:05.0f}\n",
             times.total(), times.least(), times.average(), times.most());
  fmt::print("# Histogram Overflows: {:05}\n", times.overflows());
}

}  // namespace greenloop
