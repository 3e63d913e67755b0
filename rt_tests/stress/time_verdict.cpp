#include "rt_tests/stress/time_verdict.hpp"

#include <fmt/format.h>
#include <sched.h>

#include <fstream>
#include <sstream>

namespace greenloop {
namespace {

// whether a list such as "1-3,6" names a processor
bool names(const std::string& list, int processor) {
  std::istringstream ranges(list);
  for (std::string range; std::getline(ranges, range, ',');) {
    int first = -1;
    char dash = 0;
    std::istringstream ends(range);
    ends >> first;
    int last = first;
    if (ends >> dash) ends >> last;
    if (first >= 0 && first <= processor && processor <= last) return true;
  }
  return false;
}

std::string why_unfit() {
  cpu_set_t allowed;
  if (sched_getaffinity(0, sizeof allowed, &allowed) != 0) return "the processors of this thread are not known";
  if (CPU_COUNT(&allowed) != 1) {
    return fmt::format("this thread may run on {} processors: pin it to an isolated one (taskset -c N)",
                       CPU_COUNT(&allowed));
  }
  int processor = 0;
  while (!CPU_ISSET(static_cast<std::size_t>(processor), &allowed)) ++processor;
  std::ifstream file("/sys/devices/system/cpu/isolated");
  std::string isolated;
  std::getline(file, isolated);
  if (names(isolated, processor)) return {};
  return fmt::format("processor {} is not isolated from other work (isolated: {}; kernel parameter isolcpus)",
                     processor, isolated.empty() ? "none" : isolated);
}

}  // namespace

TimeVerdict judge_times(const TimeHistogram& times, double rate, double share) {
  return {.period_us = 1e6 / rate,
          .share = share,
          .worst_us = times.most(),
          .p50_us = times.quantile(0.5),
          .p99_us = times.quantile(0.99),
          .p999_us = times.quantile(0.999),
          .unfit = why_unfit()};
}

}  // namespace greenloop
