#include "sim_hw/guard/time_verdict.hpp"

#include <fmt/format.h>
#include <sched.h>

#include <fstream>
#include <nlohmann/json.hpp>
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

std::string TimeVerdict::word() const {
  if (!is_asked || !unfit.empty()) return "NOT JUDGED";
  return within() ? "WITHIN" : "LATE";
}

std::string TimeVerdict::text(const std::string& timed) const {
  return fmt::format(
             "time {}: p50 {:.0f}, p99 {:.0f}, p99.9 {:.0f}, worst {:.0f} us of processor time a {}; the period is "
             "{:.0f} us, of which a step may take {:.0f} %\n",
             word(), p50_us, p99_us, p999_us, worst_us, timed, period_us, 100 * share) +
         (is_asked && !unfit.empty() ? "  " + unfit + "\n" : "");
}

void to_json(nlohmann::json& json, const TimeVerdict& time) {
  json = {{"period_us", time.period_us}, {"share", time.share},
          {"worst_us", time.worst_us},   {"p50_us", time.p50_us},
          {"p99_us", time.p99_us},       {"p999_us", time.p999_us},
          {"within", time.within()},     {"can_judge", time.unfit.empty()}};
}

TimeVerdict judge_times(const TimeHistogram& times, double rate, double share, bool is_asked) {
  return {.period_us = 1e6 / rate,
          .share = share,
          .worst_us = times.most(),
          .p50_us = times.quantile(0.5),
          .p99_us = times.quantile(0.99),
          .p999_us = times.quantile(0.999),
          .unfit = why_unfit(),
          .is_asked = is_asked};
}

}  // namespace greenloop
