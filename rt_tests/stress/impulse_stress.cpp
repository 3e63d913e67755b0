#include "rt_tests/stress/impulse_stress.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "formats/write/aligned_bytes.hpp"
#include "rt_tests/harness/fast_digest.hpp"
#include "rt_tests/harness/time_of.hpp"
#include "sim_hw/motion/motion_bounds.hpp"

namespace greenloop {
namespace {

using Cycle = ImpulseScript::Cycle;
using Limits = ImpulseResponse::Limits;
using Requirement = ImpulseResponse::Requirement;
using Response = ImpulseResponse::Response;
using StepReport = ImpulseResponse::StepReport;

constexpr std::uint32_t no_impulse = ImpulseResponse::no_impulse;
constexpr std::uint64_t warm_up_cycles = 200;    // before the scripts: their pages are not of the loop
constexpr std::uint64_t progress_interval = 64;  // cycles
constexpr std::uint64_t pace_cycles = 200;       // of one body of `paces`
constexpr const char* changed = "a refused step changed the answer";
constexpr double rounding = 1.001;  // single precision may miss the bound of the energy by

/// A body, its memory and buffers.
class Body {
 public:
  Body(const Model& model, const Limits& limits)
      : model_(&model), memory_(ImpulseResponse::required(model, limits).bytes) {
    const ImpulseResponseView& view = model.view().impulse_response;
    coordinate_.resize(view.modes);
    velocity_.resize(view.modes);
    displacement_.resize(view.info->vertices + 1);
    displacement_rate_.resize(view.info->vertices + 1);
    colour_.resize(view.info->vertices + 1);
    renew(limits);
  }

  void renew(const Limits& limits) {
    const auto created = ImpulseResponse::create(*model_, limits, {memory_.data(), memory_.size()});
    if (!created) throw std::runtime_error("no body of motions for this model and these limits");
    body = created.body;
    need = ImpulseResponse::required(*model_, limits);
    std::fill(coordinate_.begin(), coordinate_.end(), 0.0F);
    std::fill(velocity_.begin(), velocity_.end(), 0.0F);
    std::fill(displacement_.begin(), displacement_.end(), Vec3{});
    std::fill(displacement_rate_.begin(), displacement_rate_.end(), Vec3{});
    std::fill(colour_.begin(), colour_.end(), Vec3{});
  }

  [[nodiscard]] Response response(const Cycle& cycle) {
    return response_of(cycle, {coordinate_, velocity_, displacement_, displacement_rate_, colour_});
  }
  [[nodiscard]] const std::vector<float>& coordinate() const { return coordinate_; }
  [[nodiscard]] const std::vector<float>& velocity() const { return velocity_; }

  ImpulseResponse body;
  Requirement need;

 private:
  const Model* model_;
  AlignedBytes memory_;
  std::vector<float> coordinate_, velocity_;
  std::vector<Vec3> displacement_, displacement_rate_, colour_;
};

std::uint64_t digest_of(const Response& response) {
  FastDigest digest;
  digest.add(std::as_bytes(response.coordinate));
  digest.add(std::as_bytes(response.velocity));
  digest.add(std::as_bytes(response.displacement));
  digest.add(std::as_bytes(response.displacement_rate));
  digest.add(std::as_bytes(response.colour));
  return digest.value();
}

void add(const StepReport& report, FastDigest& digest) {
  const std::uint64_t facts[] = {static_cast<std::uint64_t>(report.status),
                                 report.work,
                                 report.orbit,
                                 report.row,
                                 report.impulse,
                                 report.modes,
                                 report.planes,
                                 report.transfer_modes,
                                 report.at_rest ? 1U : 0U,
                                 std::bit_cast<std::uint32_t>(report.truncation_error),
                                 std::bit_cast<std::uint32_t>(report.transfer_error),
                                 std::bit_cast<std::uint32_t>(report.distance),
                                 std::bit_cast<std::uint32_t>(report.blend)};
  digest.add(std::span<const std::uint64_t>(facts));
}

bool same_bits(const std::vector<float>& a, const std::vector<float>& b) {
  const auto same = [](float x, float y) { return std::bit_cast<std::uint32_t>(x) == std::bit_cast<std::uint32_t>(y); };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), same);
}

class ImpulseStressRun {
 public:
  ImpulseStressRun(const Model& model, const ImpulseStressOptions& options)
      : model_(&model), options_(options), tried_(model, options.limits), twin_(model, options.limits) {
    result_.declared = tried_.need;
    result_.energy_bound = energy_bound(options.limits);
    result_.times = TimeHistogram(options.histogram_bins);
  }

  ImpulseStressResult run() {
    result_.watches_system_calls = guarded_.prepare();
    result_.create_ms = time_of(1, [this] { tried_.renew(options_.limits); }) / 1e3;
    check_limits();
    ImpulseStressScript warm_up(*model_, tried_.need, ImpulseScriptKind::frames, options_.seed);
    for (std::uint64_t i = 0; i < warm_up_cycles; ++i) {
      const Cycle cycle = warm_up.next(tried_.body);
      static_cast<void>(tried_.body.step(cycle.impulse, cycle.budget, tried_.response(cycle)));
    }
    visit_kinds(options_, impulse_script_names,
                [this](ImpulseScriptKind kind, std::uint64_t cycles) { run_script(kind, cycles); });
    result_.digest = digest_.value();
    return result_;
  }

 private:
  [[nodiscard]] double energy_bound(const Limits& limits) const {
    const double reach = motion_bounds(*model_, limits).state.reach();
    return reach * reach * rounding;
  }

  // what no body can have
  void check_limits() {
    constexpr float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
    AlignedBytes memory(result_.declared.bytes);
    for (const float wrong : {nan, infinity, -infinity, -1.0F, 1e-38F, 1e-45F, 1e38F}) {
      for (const Limits& limits : {Limits{.rate = wrong}, Limits{.stretch = wrong}, Limits{.blend_rate = wrong}}) {
        const auto created = ImpulseResponse::create(*model_, limits, {memory.data(), memory.size()});
        const bool refused =
            created.error == CreateError::bad_limits && ImpulseResponse::required(*model_, limits).bytes == 0;
        ++(refused ? result_.wrong_limits : result_.violations.wrong_answers);
        if (!refused && !result_.first_violation) {
          result_.first_violation = {ImpulseScriptKind::mixed, 0, "limits that are none were not refused"};
        }
      }
    }
  }

  // on a body as in a run of this script alone
  void run_script(ImpulseScriptKind kind, std::uint64_t cycles) {
    begin(options_.limits);
    ImpulseStressScript script(*model_, tried_.need, kind, options_.seed);
    script_ = {};
    script_.kind = kind;
    script_digest_ = {};
    for (; script_.cycles < cycles; ++script_.cycles, ++result_.cycles) {
      if (options_.progress && result_.cycles % progress_interval == 0) options_.progress(kind, result_.cycles);
      if (kind == ImpulseScriptKind::paces && script_.cycles % pace_cycles == 0) {
        begin(script.limits());
        script.declare(tried_.need);
      }
      Cycle cycle = script.next(tried_.body);
      if (options_.budget > 0) cycle.budget.work = options_.budget;
      step(cycle);
    }
    script_.digest = script_digest_.value();
    digest_.add(std::span<const std::uint64_t>(&script_.digest, 1));
    result_.counts.add(script_.counts);
    result_.scripts.push_back(script_);
  }

  void begin(const Limits& limits) {
    tried_.renew(limits);
    twin_.renew(limits);
    bound_ = energy_bound(limits);
    blend_ = 0;
  }

  void step(const Cycle& cycle) {
    const std::uint64_t violations = result_.violations.sum();
    const bool legal = cycle.impulse == no_impulse || tried_.body.may_follow(cycle.impulse);
    const Response response = tried_.response(cycle);
    const bool refusable = may_be_refused(cycle, legal, model_->view().impulse_response, tried_.need);
    const std::uint64_t before = refusable ? digest_of(response) : 0;
    StepReport report;
    const double start = thread_microseconds();
    guarded_.run([&] { report = tried_.body.step(cycle.impulse, cycle.budget, response); },
                 [&] { report.work += tried_.need.worst_work; },
                 script_.cycles % GuardedSteps::fault_interval == GuardedSteps::fault_interval - 1, result_.violations);
    const double us = thread_microseconds() - start;
    result_.times.add(us);
    script_.worst_us = std::max(script_.worst_us, us);
    const std::uint64_t now = digest_of(response);
    add(report, script_digest_);
    script_digest_.add(std::span<const std::uint64_t>(&now, 1));
    count(cycle, report);
    const char* wrong = what_is_wrong(cycle, report, legal, model_->view().impulse_response, tried_.need, response);
    const char* const state = answered(report.status) ? check_state(cycle) : before == now ? nullptr : changed;
    if (wrong == nullptr) wrong = state;
    const bool overran = report.work > cycle.budget.work || report.work > tried_.need.worst_work;
    result_.violations.work_overruns += overran ? 1 : 0;
    result_.violations.wrong_answers += wrong != nullptr && !overran ? 1 : 0;
    if (!result_.first_violation && result_.violations.sum() > violations) {
      result_.first_violation = {script_.kind, script_.cycles, wrong != nullptr ? wrong : "a call or fault in a step"};
    }
  }

  // of a step that was answered: its energy, and that it is where steps that were refused have not been
  const char* check_state(const Cycle& cycle) {
    const double energy = state_energy(model_->view().impulse_response, tried_.coordinate(), tried_.velocity());
    ImpulseCounts& counts = script_.counts;
    if (script_.kind != ImpulseScriptKind::paces) counts.most_energy = std::max(counts.most_energy, energy);
    counts.most_energy_share = std::max(counts.most_energy_share, bound_ > 0 ? energy / bound_ : 0);
    if (energy > bound_) return "the state has more energy than it can have";
    static_cast<void>(twin_.body.step(cycle.impulse, {twin_.need.least_work}, twin_.response({})));
    const bool same =
        same_bits(tried_.coordinate(), twin_.coordinate()) && same_bits(tried_.velocity(), twin_.velocity());
    return same ? nullptr : "the state is not that of a body that was never given what was refused";
  }

  void count(const Cycle& cycle, const StepReport& report) {
    ImpulseCounts& counts = script_.counts;
    ++counts.by_status[static_cast<std::size_t>(report.status)];
    counts.spend(report.work, tried_.need.worst_work);
    if (!answered(report.status)) return;
    const bool entered = cycle.impulse != no_impulse;
    counts.entered += entered ? 1 : 0;
    counts.blending += entered && blend_ > 0 ? 1 : 0;
    counts.continued += !entered && report.distance > 0 ? 1 : 0;
    counts.most_blend = std::max(counts.most_blend, static_cast<double>(report.blend));
    blend_ = report.blend;
  }

  const Model* model_;
  ImpulseStressOptions options_;
  Body tried_, twin_;
  double bound_ = 0;  // m^2
  float blend_ = 0;   // of the last answered step
  ScriptOutcome<ImpulseScriptKind, ImpulseCounts> script_;
  ImpulseStressResult result_;
  FastDigest script_digest_, digest_;
  GuardedSteps guarded_{options_.fault};
};

ReportedStep reported(const Cycle& cycle, const StepReport& report) {
  if (!answered(report.status)) return {"", report.work};
  std::string way = cycle.chosen_count > 0 ? "chosen vertices" : cycle.vertices > 0 ? "first vertices" : "state";
  if (cycle.chosen_count + cycle.vertices > 0 && cycle.rates) way += ", velocities";
  if (cycle.chosen_count + cycle.vertices > 0 && cycle.lit) way += ", colours";
  return {way, report.work};
}

}  // namespace

void ImpulseCounts::add(const ImpulseCounts& other) {
  StepCounts::add(other);
  entered += other.entered;
  blending += other.blending;
  continued += other.continued;
  most_blend = std::max(most_blend, other.most_blend);
  most_energy = std::max(most_energy, other.most_energy);
  most_energy_share = std::max(most_energy_share, other.most_energy_share);
}

ImpulseStressResult run_impulse_stress(const Model& model, const ImpulseStressOptions& options) {
  return ImpulseStressRun(model, options).run();
}

std::vector<ReportedStep> run_impulses_plainly(const Model& model, const ImpulseStressOptions& options) {
  Body body(model, options.limits);
  std::vector<ReportedStep> steps;
  const auto step = [&](const Cycle& cycle) {
    steps.push_back(reported(cycle, body.body.step(cycle.impulse, cycle.budget, body.response(cycle))));
  };
  visit_kinds(options, impulse_script_names, [&](ImpulseScriptKind kind, std::uint64_t cycles) {
    body.renew(options.limits);
    ImpulseStressScript script(model, body.need, kind, options.seed);
    for (std::uint64_t i = 0; i < cycles; ++i) {
      if (kind == ImpulseScriptKind::paces && i % pace_cycles == 0) {
        body.renew(script.limits());
        script.declare(body.need);
      }
      Cycle cycle = script.next(body.body);
      if (options.budget > 0) cycle.budget.work = options.budget;
      step(cycle);
    }
  });
  body.renew(options.limits);
  Cycle heaviest;
  heaviest.impulse = 0;
  for (std::uint32_t i = 0; i < model.view().impulse_response.info->impulses; ++i) {
    if (body.body.may_follow(i)) heaviest.impulse = i;
  }
  heaviest.vertices = model.view().impulse_response.info->vertices;
  heaviest.rates = true;
  heaviest.lit = model.view().impulse_response.appearance.modes > 0;
  heaviest.light.red[0] = heaviest.light.green[1] = heaviest.light.blue[2] = 1;
  heaviest.budget.work = body.need.worst_work;
  step(heaviest);
  return steps;
}

}  // namespace greenloop
