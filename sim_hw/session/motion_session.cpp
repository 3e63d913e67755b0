#include "sim_hw/session/motion_session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "formats/write/aligned_bytes.hpp"
#include "sim_hw/motion/impulse_device.hpp"
#include "sim_hw/session/loaded_model.hpp"
#include "sim_hw/session/run_verdict.hpp"

namespace greenloop {
namespace {

constexpr double display_rate = 60;  // Hz
constexpr double rounding = 1.001;   // single precision may miss a bound by

Budget budget_of(const SessionOptions& options, const ImpulseResponse::Requirement& need) {
  const std::uint64_t whole = options.budget != 0 ? options.budget : need.frame_work;
  const Budget budget{static_cast<std::uint64_t>(std::floor(static_cast<double>(whole) * options.starve))};
  if (budget.work < need.least_frame_work) {
    throw std::runtime_error(
        "budget: " + std::to_string(budget.work) +
        " units per cycle cannot hold even the coarsest frame; the least budget of this model is " +
        std::to_string(need.least_frame_work));
  }
  return budget;
}

double square(double x) { return x * x; }

}  // namespace

MotionResult run_motion_session(const SessionOptions& options) {
  const LoadedModel loaded = load_model(options.model, layout::Problem::impulse_response);
  const layout::ImpulseInfo& info = *loaded.model.view().impulse_response.info;
  MotionResult result;
  result.rate = options.rate.value_or(static_cast<double>(info.rate));
  result.share = options.share.value_or(1);
  result.modes = loaded.model.view().impulse_response.modes;
  result.field_every =
      options.field_every.value_or(std::max<std::int64_t>(1, std::llround(result.rate / display_rate)));
  result.cycles_asked = std::max<std::int64_t>(1, std::llround(options.seconds * result.rate));
  const ImpulseResponse::Limits limits{.rate = static_cast<float>(result.rate)};
  const ImpulseResponse::Requirement need = ImpulseResponse::required(loaded.model, limits);
  AlignedBytes memory(need.bytes);
  const auto created = ImpulseResponse::create(loaded.model, limits, {memory.data(), memory.size()});
  if (!created) {
    throw std::runtime_error(options.model.string() + ": rate: at " + std::to_string(result.rate) +
                             " Hz a cycle would pass more than 64 of the model's states; give another with --rate");
  }
  result.least_work = need.least_frame_work;
  result.budget = budget_of(options, need);
  result.bounds = motion_bounds(loaded.model, limits);
  result.log = MotionLog(static_cast<std::size_t>(result.cycles_asked), result.modes, info.velocity_balance,
                         options.keep_records);
  MotionLoop loop(loaded.model, created.body,
                  {.budget = result.budget, .field_every = result.field_every, .overrun_cycle = options.overrun_cycle});
  ImpulseDevice device(
      {.impulses = info.impulses, .rate = result.rate, .cycles = result.cycles_asked, .faults = options.faults});
  choose_transport(options.transport, result);
  run_link(device, loop, result.log, result);
  result.device = device.summary();
  return result;
}

MotionVerdict judge(const MotionResult& result, bool judge_time) {
  MotionVerdict verdict;
  static_cast<MotionTally&>(verdict) = result.log.tally();
  verdict.time = judge_times(histogram(result.log.cpu_us(), result.rate), result.rate, result.share, judge_time);
  verdict.complete = is_complete(result, result.device, verdict);
  const MotionBounds& bounds = result.bounds;
  verdict.smooth = verdict.position_jump <= rounding * bounds.displacement.jump() &&
                   verdict.velocity_jump <= rounding * bounds.velocity.jump() &&
                   verdict.energy <= rounding * square(bounds.state.reach());
  verdict.held = verdict.misses == 0 && verdict.not_held == 0 && result.allocations == 0 &&
                 result.device.late <= result.device.late_injected && verdict.smooth && verdict.complete;
  return verdict;
}

nlohmann::ordered_json to_json(const SessionOptions& options, const MotionResult& result,
                               const MotionVerdict& verdict) {
  nlohmann::ordered_json json = opening_json(verdict.passed(), verdict.held, verdict.time, "impulses", options.seconds,
                                             result, result.device, verdict);
  json.update(nlohmann::ordered_json{
      {"digest", digest_text(result)},
      {"allocations", result.allocations},
      {"impulses", verdict.entered},
      {"blending", verdict.blending},
      {"continued", verdict.continued},
      {"refused", {{"illegal", verdict.illegal}, {"unknown", verdict.unknown}, {"not_held", verdict.not_held}}},
      {"frames",
       {{"count", verdict.frames},
        {"every", result.field_every},
        {"coarser", verdict.coarser},
        {"rank", result.modes},
        {"least_rank", verdict.least_rank},
        {"truncation_error", verdict.truncation_error}}},
      {"position_jump_max", verdict.position_jump},
      {"position_jump_bound", result.bounds.displacement.jump()},
      {"position_step_max", verdict.position_step},
      {"velocity_jump_max", verdict.velocity_jump},
      {"velocity_jump_bound", result.bounds.velocity.jump()},
      {"velocity_step_max", verdict.velocity_step},
      {"blend_max", verdict.blend},
      {"energy_max", verdict.energy},
      {"energy_bound", square(result.bounds.state.reach())},
  });
  add_transport(verdict.time, result, result.device, json);
  add_reasons(result, json);
  return json;
}

std::string to_text(const SessionOptions& options, const MotionResult& result, const MotionVerdict& verdict) {
  std::string text = headline(verdict.held, result, result.device, verdict);
  text += verdict.time.text("cycle");
  text += fmt::format("  model      {}\n", options.model.string());
  text += fmt::format("  impulses   {}, {} of them in the midst of a blend; {} orbits went on in others\n",
                      verdict.entered, verdict.blending, verdict.continued);
  text +=
      fmt::format("  refused    {} that may not follow, {} that are none; the last state was held{}\n", verdict.illegal,
                  verdict.unknown, verdict.not_held > 0 ? fmt::format(" but for {} times", verdict.not_held) : "");
  text +=
      fmt::format("  jumps      at switches {:.3g} m, {:.3g} m/s, bounds {:.3g}, {:.3g}; elsewhere {:.3g}, {:.3g}\n",
                  verdict.position_jump, verdict.velocity_jump, result.bounds.displacement.jump(),
                  result.bounds.velocity.jump(), verdict.position_step, verdict.velocity_step);
  text += fmt::format("  energy     at most {:.3g} m^2, bound {:.3g}; differences of at most {:.3g} m died out\n",
                      verdict.energy, square(result.bounds.state.reach()), verdict.blend);
  text +=
      fmt::format("  frames     {}, {} of them by fewer than {} modes, the coarsest by {}, off by {:.2g} %\n",
                  verdict.frames, verdict.coarser, result.modes, verdict.least_rank, 100 * verdict.truncation_error);
  text += work_line(result, verdict);
  return text + ending(verdict.complete, result, result.device, verdict);
}

}  // namespace greenloop
