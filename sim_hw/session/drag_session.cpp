#include "sim_hw/session/drag_session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "formats/write/aligned_bytes.hpp"
#include "sim_hw/drag/drag_device.hpp"
#include "sim_hw/drag/soft_vertices.hpp"
#include "sim_hw/session/loaded_model.hpp"
#include "sim_hw/session/run_verdict.hpp"

namespace greenloop {
namespace {

constexpr double display_rate = 60;        // Hz
constexpr double reach = 0.1;              // of the body's size, that the tool drags
constexpr std::uint64_t usual_cycles = 4;  // of multigrid, that a budget holds which nobody names
constexpr Multigrid::Limits limits{.max_loads = 0, .max_holds = 1};

Budget budget_of(const SessionOptions& options, const Multigrid::Requirement& need) {
  const std::uint64_t least = need.least_work + need.shown_work;
  const std::uint64_t whole = options.budget != 0 ? options.budget : least + (usual_cycles - 1) * need.cycle_work;
  const Budget budget{static_cast<std::uint64_t>(std::floor(static_cast<double>(whole) * options.starve))};
  if (budget.work < least) {
    throw std::runtime_error("budget: " + std::to_string(budget.work) +
                             " units per cycle cannot hold even a step of one multigrid cycle; the least budget of "
                             "this model is " +
                             std::to_string(least));
  }
  return budget;
}

}  // namespace

DragResult run_drag_session(const SessionOptions& options) {
  const LoadedModel loaded = load_model(options.model, layout::Problem::multigrid);
  const MultigridView& view = loaded.model.view().multigrid;
  DragResult result;
  result.rate = 1 / view.info->time_step;
  result.share = options.share.value_or(1);
  result.tetrahedra = view.info->tetrahedra;
  result.size = static_cast<double>(view.info->size);
  result.field_every =
      options.field_every.value_or(std::max<std::int64_t>(1, std::llround(result.rate / display_rate)));
  result.cycles_asked = std::max<std::int64_t>(1, std::llround(options.seconds * result.rate));
  const Multigrid::Requirement need = Multigrid::required(loaded.model, limits);
  AlignedBytes memory(need.bytes);
  const auto created = Multigrid::create(loaded.model, limits, {memory.data(), memory.size()});
  if (!created) throw std::runtime_error(options.model.string() + ": no body of this model");
  result.least_work = need.least_work + need.shown_work;
  result.budget = budget_of(options, need);
  result.log = DragLog(view, static_cast<std::size_t>(result.cycles_asked), options.keep_records);
  DragLoop loop(loaded.model, created.body,
                {.budget = result.budget, .field_every = result.field_every, .overrun_cycle = options.overrun_cycle});
  DragDevice device({.vertices = soft_vertices(view),
                     .reach = reach * result.size,
                     .rate = result.rate,
                     .cycles = result.cycles_asked,
                     .faults = options.faults});
  choose_transport(options.transport, result);
  run_link(device, loop, result.log, result);
  result.device = device.summary();
  return result;
}

DragVerdict judge(const DragResult& result, bool judge_time) {
  DragVerdict verdict;
  static_cast<DragTally&>(verdict) = result.log.tally();
  verdict.time = judge_times(histogram(result.log.cpu_us(), result.rate), result.rate, result.share, judge_time);
  verdict.complete = is_complete(result, result.device, verdict);
  verdict.bounded = verdict.refused == 0 && verdict.farthest <= result.size;
  verdict.held = verdict.misses == 0 && result.allocations == 0 && result.device.late <= result.device.late_injected &&
                 verdict.bounded && verdict.complete;
  return verdict;
}

nlohmann::ordered_json to_json(const SessionOptions& options, const DragResult& result, const DragVerdict& verdict) {
  nlohmann::ordered_json json = opening_json(verdict.passed(), verdict.held, verdict.time, "drag", options.seconds,
                                             result, result.device, verdict);
  json.update(nlohmann::ordered_json{
      {"digest", digest_text(result)},
      {"allocations", result.allocations},
      {"tetrahedra", result.tetrahedra},
      {"field_every", result.field_every},
      {"grasps", verdict.grasps},
      {"coarser", verdict.coarser},
      {"refused", verdict.refused},
      {"multigrid_cycles", {{"mean", verdict.mean_multigrid_cycles()}, {"max", verdict.most_multigrid_cycles}}},
      {"residual", {{"mean", verdict.mean_residual()}, {"max", verdict.residual}}},
      {"force_max", verdict.force},
      {"displacement_max", verdict.farthest},
      {"displacement_bound", result.size},
      {"energy",
       {{"kinetic_max", verdict.kinetic},
        {"kinetic_end", verdict.kinetic_left},
        {"elastic_max", verdict.elastic},
        {"gain_max", verdict.gain}}},
  });
  add_transport(verdict.time, result, result.device, json);
  add_reasons(result, json);
  return json;
}

std::string to_text(const SessionOptions& options, const DragResult& result, const DragVerdict& verdict) {
  std::string text = headline(verdict.held, result, result.device, verdict);
  text += verdict.time.text("cycle");
  text += fmt::format("  model      {}, {} tetrahedra\n", options.model.string(), result.tetrahedra);
  text += fmt::format("  tool       took hold {} times, with at most {:.3g} N\n", verdict.grasps, verdict.force);
  text += fmt::format("  body       displaced by at most {:.3g} m, {:.3g} allowed; {} cycles refused\n",
                      verdict.farthest, result.size, verdict.refused);
  text += fmt::format(
      "  energy     kinetic at most {:.3g} J, {:.3g} at the end; elastic at most {:.3g}; {:.2g} beyond the tool's "
      "work\n",
      verdict.kinetic, verdict.kinetic_left, verdict.elastic, verdict.gain);
  text += fmt::format(
      "  multigrid  {:.2f} cycles a step, at most {}; residual {:.2g}, at most {:.2g}; {} short of the tolerance\n",
      verdict.mean_multigrid_cycles(), verdict.most_multigrid_cycles, verdict.mean_residual(), verdict.residual,
      verdict.coarser);
  text += work_line(result, verdict);
  return text + ending(verdict.complete, result, result.device, verdict);
}

}  // namespace greenloop
