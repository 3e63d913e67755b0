#include "rt_tests/stress/report_parts.hpp"

#include "sim_hw/control_loop/status_name.hpp"

namespace greenloop {

double declared_over(std::uint64_t declared, std::uint64_t worst) {
  return worst > 0 ? static_cast<double>(declared) / static_cast<double>(worst) : 0;
}

nlohmann::json statuses_json(const StepsByStatus& steps) {
  nlohmann::json json;
  for (std::size_t i = 0; i < statuses; ++i) json[name(static_cast<Status>(i))] = steps[i];
  return json;
}

void print_statuses(const StepsByStatus& steps) {
  fmt::print("steps by status:");
  for (std::size_t i = 0; i < statuses; ++i) {
    if (steps[i] > 0) fmt::print("  {} {}", name(static_cast<Status>(i)), steps[i]);
  }
  fmt::print("\n");
}

void add_violations(const Violations& violations, bool watches_system_calls, nlohmann::json& all) {
  for (const auto& [name, count] : named(violations)) all[name] = count;
  if (!watches_system_calls) all["syscalls"] = nullptr;
}

void print_if_unwatched(bool watches_system_calls) {
  if (!watches_system_calls) fmt::print("system calls not watched: this kernel has no Syscall User Dispatch\n");
}

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
