#include "sim_hw/session/verdict.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <vector>

#include "sim_hw/session/run_verdict.hpp"

namespace greenloop {
namespace {

StepTime step_time(std::vector<float> time) {
  if (time.empty()) return {};
  std::sort(time.begin(), time.end());
  const auto quantile = [&](double q) {
    return static_cast<double>(time[static_cast<std::size_t>(q * static_cast<double>(time.size() - 1))]);
  };
  return {quantile(0), quantile(0.5), quantile(0.99), quantile(1)};
}

nlohmann::ordered_json vector_json(const Double3& v) { return {v.x, v.y, v.z}; }

// what the tools feel in the cycle of the largest force
nlohmann::ordered_json tools_json(const CycleRecord& record, std::uint32_t tools) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (std::uint32_t p = 0; p < tools; ++p) {
    json.push_back({{"force", vector_json(record.hand_force[p])},
                    {"torque", vector_json(record.hand_torque[p])},
                    {"contacts", record.touching[p]}});
  }
  return json;
}

// N: errors against stepping the body at the fast rate
nlohmann::ordered_json fast_json(const FastLoop& fast, double rate) {
  return {{"rate", rate},
          {"cycles", fast.cycles},
          {"in_range", fast.in_range},
          {"error_rms", FastLoop::relative(fast.error_square, fast.square)},
          {"held_error_rms", FastLoop::relative(fast.held_square, fast.square)},
          {"step_error_rms", FastLoop::relative(fast.step_error_square, fast.step_square)},
          {"error_max", fast.error_most},
          {"held_error_max", fast.held_most},
          {"force_max", fast.force_most},
          {"local_work", fast.work_most}};
}

std::string levels_text(const Verdict& verdict) {
  std::string text;
  for (const auto& [level, cycles] : verdict.levels_used) {
    text += fmt::format("{}level {} in {} cycles", text.empty() ? "" : ", ", level, cycles);
  }
  return text;
}

}  // namespace

Verdict judge(const SessionResult& result, bool judge_time) {
  Verdict verdict;
  static_cast<RunTally&>(verdict) = result.log.tally();
  for (std::uint32_t level = 0; level < verdict.at_level.size(); ++level) {
    if (verdict.at_level[level] > 0) verdict.levels_used[level] = verdict.at_level[level];
  }
  verdict.energy = verdict.last.energy;
  verdict.step_us = step_time(result.log.cpu_us());
  verdict.time = judge_times(histogram(result.log.cpu_us(), result.rate), result.rate, result.share, judge_time);
  verdict.complete = is_complete(result, result.device, verdict);
  verdict.held = verdict.misses == 0 && result.allocations == 0 && result.device.late <= result.device.late_injected &&
                 verdict.complete;
  return verdict;
}

nlohmann::ordered_json to_json(const SessionOptions& options, const SessionResult& result, const Verdict& verdict) {
  nlohmann::ordered_json levels = nlohmann::ordered_json::array();
  for (const auto& [level, cycles] : verdict.levels_used) levels.push_back({{"level", level}, {"cycles", cycles}});
  const DeviceSummary& device = result.device;
  nlohmann::ordered_json json =
      opening_json(verdict.passed(), verdict.held, verdict.time, script_names[static_cast<std::size_t>(options.script)],
                   options.seconds, result, result.device, verdict);
  json.update(nlohmann::ordered_json{
      {"levels_used", levels},
      {"digest", digest_text(result)},
      {"allocations", result.allocations},
      {"contact_cycles", verdict.contact_cycles},
      {"contacts_max", verdict.contacts_max},
      {"force_max", verdict.force_max},
      {"friction", options.friction},
      {"tools", tools_json(verdict.strongest, result.tools)},
      {"energy",
       {{"in", verdict.energy.in},
        {"stored", verdict.energy.stored},
        {"dissipated", verdict.energy.dissipated},
        {"lost", verdict.energy.lost},
        {"generated", verdict.energy.generated},
        {"from_loads", verdict.energy.from_loads},
        {"handled", verdict.handled},
        {"delivered", device.delivered},
        {"delivered_most", device.delivered_most},
        {"overdrawn", device.overdrawn},
        {"drained", device.drained}}},
      {"passive", passive_names[static_cast<std::size_t>(options.passive)]},
      {"hand", holder_names[static_cast<std::size_t>(options.hand)]},
      {"delay", options.delay},
      {"gain", options.gain},
      {"residual_max", verdict.residual_max},
      {"force_step_max", verdict.force_step_max},
      {"fall_throughs", verdict.fall_throughs},
      {"touching_work", verdict.worst_touching},
      {"step_us",
       {{"min", verdict.step_us.min},
        {"median", verdict.step_us.median},
        {"p99", verdict.step_us.p99},
        {"max", verdict.step_us.max}}},
  });
  add_transport(verdict.time, result, result.device, json);
  if (!options.motions.empty()) {
    const MotionsGiven& motions = verdict.motions;
    json["impulses"] = motions.followed;
    json["refused"] = {{"illegal", motions.illegal}, {"unknown", motions.unknown}};
    json["motions"] = {{"coarser", motions.coarser}, {"offset_max", motions.offset}};
  }
  if (options.fast_rate) json["fast"] = fast_json(verdict.fast, *options.fast_rate);
  add_reasons(result, json);
  return json;
}

std::string to_text(const SessionOptions& options, const SessionResult& result, const Verdict& verdict) {
  std::string text = headline(verdict.held, result, result.device, verdict);
  text += verdict.time.text("cycle");
  text += fmt::format("  model      {}\n", options.model.string());
  text += fmt::format("  script     {}: {} cycles in contact, at most {} contacts, {:.3g} N\n",
                      script_names[static_cast<std::size_t>(options.script)], verdict.contact_cycles,
                      verdict.contacts_max, verdict.force_max);
  text += fmt::format(
      "  contact    friction {:.2g}, laws within {:.1e}, force steps of at most {:.3g} N, {} fall-throughs\n",
      options.friction, verdict.residual_max, verdict.force_step_max, verdict.fall_throughs);
  text += fmt::format("  energy     {:.3g} J in, {:.3g} J stored, {:.3g} J by friction, {:.2g} J generated\n",
                      verdict.energy.in, verdict.energy.stored, verdict.energy.dissipated, verdict.energy.generated);
  text += fmt::format(
      "  hand       {}, passive {}: {:.2g} J out of nothing at the handles, {:.2g} J overdrawn, {:.2g} J braked\n",
      holder_names[static_cast<std::size_t>(options.hand)], passive_names[static_cast<std::size_t>(options.passive)],
      result.device.delivered_most, result.device.overdrawn, result.device.drained);
  if (options.fast_rate) {
    const FastLoop& fast = verdict.fast;
    text += fmt::format("  fast       {} Hz, {} of {} cycles in range, off by {:.2g} % (held: {:.2g} %) of the force\n",
                        *options.fast_rate, fast.in_range, fast.cycles,
                        100 * FastLoop::relative(fast.error_square, fast.square),
                        100 * FastLoop::relative(fast.held_square, fast.square));
  }
  if (!options.motions.empty()) {
    const MotionsGiven& motions = verdict.motions;
    text += fmt::format("  motions    {} impulses, {} refused; the surface moved by at most {:.3g} m\n",
                        motions.followed, motions.illegal + motions.unknown, motions.offset);
  }
  text += work_line(result, verdict);
  text += fmt::format("  levels     {}\n", levels_text(verdict));
  return text + ending(verdict.complete, result, result.device, verdict);
}

}  // namespace greenloop
