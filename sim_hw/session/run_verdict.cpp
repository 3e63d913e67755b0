#include "sim_hw/session/run_verdict.hpp"

#include <fmt/format.h>

#include <cstddef>

namespace greenloop {

TimeHistogram histogram(const std::vector<float>& cpu_us, double rate) {
  TimeHistogram times(static_cast<std::size_t>(1e6 / rate) + 1);
  for (const float us : cpu_us) times.add(static_cast<double>(us));
  return times;
}

bool is_complete(const LinkResult& result, const LinkSummary& device, const CycleTally& tally) {
  return tally.cycles == result.cycles_asked && device.cycles == result.cycles_asked &&
         device.digest == result.loop_digest && !device.stopped;
}

std::string digest_text(const LinkResult& result) {
  return fmt::format("{:016x}", static_cast<std::uint64_t>(result.loop_digest));
}

nlohmann::ordered_json opening_json(bool passed, bool held, const TimeVerdict& time, std::string_view script,
                                    double seconds, const LinkResult& result, const LinkSummary& device,
                                    const CycleTally& tally) {
  return {{"passed", passed},
          {"verdict", held ? "HELD" : "VIOLATED"},
          {"time_verdict", time.word()},
          {"script", script},
          {"seconds", seconds},
          {"rate", result.rate},
          {"cycles", tally.cycles},
          {"misses", tally.misses},
          {"late", device.late},
          {"late_injected", device.late_injected},
          {"stopped", device.stopped},
          {"budget_work", result.budget.work},
          {"least_work", result.least_work},
          {"worst_work", tally.worst_work}};
}

void add_transport(const TimeVerdict& time, const LinkResult& result, const LinkSummary& device,
                   nlohmann::ordered_json& json) {
  json["time"] = nlohmann::json(time);
  json["transport"] = result.transport;
  json["processes"] = result.processes;
  json["retransmits"] = device.retransmits;
}

void add_reasons(const LinkResult& result, nlohmann::ordered_json& json) {
  if (result.interruption != 0) json["interrupted_by"] = result.interruption;
  if (!result.transport_reason.empty()) json["reason"] = result.transport_reason;
}

std::string headline(bool held, const LinkResult& result, const LinkSummary& device, const CycleTally& tally) {
  return fmt::format("{}: {} of {} cycles at {} Hz, {} misses, {} late, {} allocations\n", held ? "HELD" : "VIOLATED",
                     tally.cycles, result.cycles_asked, result.rate, tally.misses, device.late, result.allocations);
}

std::string work_line(const LinkResult& result, const CycleTally& tally) {
  return fmt::format("  work       at most {} of {} units per cycle ({:.1f} %); the least budget is {}\n",
                     tally.worst_work, result.budget.work,
                     100 * static_cast<double>(tally.worst_work) / static_cast<double>(result.budget.work),
                     result.least_work);
}

std::string ending(bool complete, const LinkResult& result, const LinkSummary& device, const CycleTally& tally) {
  const std::string reason = result.transport_reason.empty() ? "" : " (" + result.transport_reason + ")";
  std::string text = fmt::format("  digest     {}\n", digest_text(result));
  text += fmt::format("  transport  {}, {} process{}{}, {} retransmissions\n", result.transport, result.processes,
                      result.processes == 1 ? "" : "es", reason, device.retransmits);
  if (tally.first_miss >= 0) text += fmt::format("  first miss in cycle {}\n", tally.first_miss);
  if (result.interruption != 0) {
    text += fmt::format("  interrupted by signal {}\n", result.interruption);
  } else if (device.stopped) {
    text += fmt::format("  stopped    {} late commands in a row\n", CommandArrival::most_in_a_row);
  } else if (!complete) {
    text += "  incomplete: device and loop do not agree on what was sent\n";
  }
  return text;
}

}  // namespace greenloop
