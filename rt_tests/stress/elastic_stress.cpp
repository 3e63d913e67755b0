#include "rt_tests/stress/elastic_stress.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "formats/write/aligned_bytes.hpp"
#include "rt_tests/harness/fast_digest.hpp"
#include "rt_tests/harness/time_of.hpp"

namespace greenloop {
namespace {

using Limits = Multigrid::Limits;
using Requirement = Multigrid::Requirement;
using Response = Multigrid::Response;
using StepReport = Multigrid::StepReport;

constexpr std::uint64_t warm_up_cycles = 50;     // before the scripts: their pages are not of the loop
constexpr std::uint64_t progress_interval = 16;  // cycles

bool is_finite(const Vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

bool is_finite(std::span<const Vec3> vectors) {
  return std::all_of(vectors.begin(), vectors.end(), [](const Vec3& v) { return is_finite(v); });
}

Multigrid::Inputs inputs_of(const ElasticCycle& cycle) {
  return {cycle.loads, cycle.holds, cycle.turned ? &cycle.gravity : nullptr};
}

/// A body, its memory and buffers.
class Body {
 public:
  Body(const Model& model, const Limits& limits)
      : need(Multigrid::required(model, limits)), model_(&model), limits_(limits), memory_(need.bytes) {
    const layout::MultigridInfo& info = *model.view().multigrid.info;
    displacement.resize(info.vertices);
    answer_.resize(info.vertices + std::size_t{1});
    reaction_.resize(limits.max_holds + std::size_t{2});
    shown_.resize(info.shown);
    stress_.resize(info.vertices);
    renew();
  }

  void renew() {
    const auto created = Multigrid::create(*model_, limits_, {memory_.data(), memory_.size()});
    if (!created) throw std::runtime_error("no body of this multigrid model for these limits");
    body = created.body;
    for (auto* const buffer : {&displacement, &answer_, &reaction_, &shown_}) {
      std::fill(buffer->begin(), buffer->end(), Vec3{});
    }
    std::fill(stress_.begin(), stress_.end(), 0.0F);
  }

  [[nodiscard]] Response response(const ElasticCycle& cycle) {
    const std::size_t displaced = cycle.chosen.empty() ? displacement.size() : cycle.chosen.size();
    return {.displacement = std::span<Vec3>(answer_).first(displaced + cycle.surplus),
            .chosen = cycle.chosen,
            .reaction = std::span<Vec3>(reaction_).first(std::min(reaction_.size(), cycle.holds.size())),
            .shown = cycle.shown ? std::span<Vec3>(shown_) : std::span<Vec3>(),
            .stress = cycle.stress ? std::span<float>(stress_) : std::span<float>()};
  }

  // displacements of all vertices, as far as they were answered
  void follow(const ElasticCycle& cycle) {
    for (std::size_t i = 0; i < cycle.chosen.size(); ++i) displacement[cycle.chosen[i]] = answer_[i];
    if (cycle.chosen.empty()) std::copy_n(answer_.begin(), displacement.size(), displacement.begin());
  }

  Multigrid body;
  Requirement need;
  std::vector<Vec3> displacement;

 private:
  const Model* model_;
  Limits limits_;
  AlignedBytes memory_;
  std::vector<Vec3> answer_, reaction_, shown_;
  std::vector<float> stress_;
};

std::uint64_t digest_of(const Response& response) {
  FastDigest digest;
  for (const std::span<Vec3> vectors : {response.displacement, response.reaction, response.shown}) {
    digest.add(std::as_bytes(vectors));
  }
  digest.add(std::as_bytes(response.stress));
  return digest.value();
}

void add(const StepReport& report, FastDigest& digest) {
  const std::uint64_t facts[] = {static_cast<std::uint64_t>(report.status), report.work, report.cycles, report.passes,
                                 std::bit_cast<std::uint32_t>(report.residual)};
  digest.add(std::span<const std::uint64_t>(facts));
}

// what is wrong with a cycle's inputs: the statuses that they may be refused with
struct Faults {
  bool not_finite = false, unknown = false, fixed = false, twice = false, size = false;

  [[nodiscard]] bool any() const { return not_finite || unknown || fixed || twice || size; }
};

Faults faults_of(const ElasticCycle& cycle, const layout::MultigridInfo& info, const Limits& limits) {
  Faults faults;
  faults.unknown = cycle.loads.size() > limits.max_loads || cycle.holds.size() > limits.max_holds;
  faults.not_finite = cycle.turned && !is_finite(cycle.gravity);
  faults.size = cycle.surplus > 0;
  for (const Multigrid::Load& load : cycle.loads) {
    faults.unknown |= load.vertex >= info.vertices;
    faults.not_finite |= !is_finite(load.force);
  }
  for (std::size_t i = 0; i < cycle.holds.size(); ++i) {
    const Multigrid::Hold& hold = cycle.holds[i];
    faults.unknown |= hold.vertex >= info.vertices;
    faults.fixed |= hold.vertex >= info.free && hold.vertex < info.vertices;
    faults.not_finite |= !is_finite(hold.displacement);
    for (std::size_t j = 0; j < i; ++j) faults.twice |= cycle.holds[j].vertex == hold.vertex;
  }
  for (const std::uint32_t v : cycle.chosen) faults.unknown |= v >= info.vertices;
  return faults;
}

std::uint64_t enough_for(const ElasticCycle& cycle, const Requirement& need) {
  return need.least_work + (cycle.shown ? need.shown_work : 0) + (cycle.stress ? need.stress_work : 0);
}

// whether a cycle may have ended so
bool may_be(Status status, const ElasticCycle& cycle, const Faults& faults, bool huge, const Requirement& need) {
  switch (status) {
    case Status::held_not_finite:
      return faults.not_finite;
    case Status::held_out_of_range:
      return faults.unknown;
    case Status::held_not_touchable:
      return faults.fixed;
    case Status::held_duplicate:
      return faults.twice;
    case Status::held_response_size:
      return faults.size;
    case Status::held_over_budget:
      return cycle.budget.work < enough_for(cycle, need);
    case Status::held_overflow:
      return huge && !faults.any();
    default:
      return answered(status) && !faults.any();
  }
}

bool is_finite(const Response& response) {
  return is_finite(std::span<const Vec3>(response.displacement)) &&
         is_finite(std::span<const Vec3>(response.reaction)) && is_finite(std::span<const Vec3>(response.shown)) &&
         std::all_of(response.stress.begin(), response.stress.end(), [](float s) { return std::isfinite(s); });
}

class ElasticStressRun {
 public:
  ElasticStressRun(const Model& model, const ElasticStressOptions& options)
      : model_(&model), options_(options), tried_(model, options.limits), twin_(model, options.limits) {
    result_.declared = tried_.need;
    result_.times = TimeHistogram(options.histogram_bins);
  }

  ElasticStressResult run() {
    result_.watches_system_calls = guarded_.prepare();
    result_.create_ms = time_of(1, [this] { tried_.renew(); }) / 1e3;
    check_limits();
    ElasticStressScript warm_up(view(), options_.limits, tried_.need, ElasticScriptKind::mixed, options_.seed);
    for (std::uint64_t i = 0; i < warm_up_cycles; ++i) {
      const ElasticCycle& cycle = warm_up.next(tried_.displacement);
      static_cast<void>(tried_.body.step(inputs_of(cycle), cycle.budget, tried_.response(cycle)));
    }
    visit_kinds(options_, elastic_script_names,
                [this](ElasticScriptKind kind, std::uint64_t cycles) { run_script(kind, cycles); });
    result_.digest = digest_.value();
    return result_;
  }

 private:
  [[nodiscard]] const MultigridView& view() const { return model_->view().multigrid; }

  // what no body can have
  void check_limits() {
    constexpr float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
    AlignedBytes memory(result_.declared.bytes);
    std::vector<Limits> wrong = {{.max_loads = 0xffffffff}, {.max_holds = 0xffffffff}};
    for (const float tolerance : {nan, infinity, -infinity, -1.0F, 0.0F, 1e-38F, 1.0F}) {
      wrong.push_back({.tolerance = tolerance});
    }
    for (const Limits& limits : wrong) {
      const auto created = Multigrid::create(*model_, limits, {memory.data(), memory.size()});
      const bool refused = created.error == CreateError::bad_limits && Multigrid::required(*model_, limits).bytes == 0;
      ++(refused ? result_.wrong_limits : result_.violations.wrong_answers);
      if (!refused && !result_.first_violation) {
        result_.first_violation = {ElasticScriptKind::mixed, 0, "limits that are none were not refused"};
      }
    }
  }

  // on a body as in a run of this script alone
  void run_script(ElasticScriptKind kind, std::uint64_t cycles) {
    tried_.renew();
    twin_.renew();
    ElasticStressScript script(view(), options_.limits, tried_.need, kind, options_.seed);
    script_ = {};
    script_.kind = kind;
    script_digest_ = {};
    for (; script_.cycles < cycles; ++script_.cycles, ++result_.cycles) {
      if (options_.progress && result_.cycles % progress_interval == 0) options_.progress(kind, result_.cycles);
      ElasticCycle cycle = script.next(tried_.displacement);
      if (options_.budget > 0) cycle.budget.work = options_.budget;
      step(cycle);
    }
    script_.digest = script_digest_.value();
    digest_.add(std::span<const std::uint64_t>(&script_.digest, 1));
    result_.counts.add(script_.counts);
    result_.scripts.push_back(script_);
  }

  void step(const ElasticCycle& cycle) {
    const std::uint64_t violations = result_.violations.sum();
    const Response response = tried_.response(cycle);
    const std::uint64_t before = digest_of(response);
    const bool is_faulty = script_.cycles % GuardedSteps::fault_interval == GuardedSteps::fault_interval - 1;
    StepReport report;
    const double start = thread_microseconds();
    guarded_.run([&] { report = tried_.body.step(inputs_of(cycle), cycle.budget, response); },
                 [&] { report.work = std::numeric_limits<std::uint64_t>::max(); }, is_faulty, result_.violations);
    const double us = thread_microseconds() - start;
    result_.times.add(us);
    script_.worst_us = std::max(script_.worst_us, us);
    const std::uint64_t now = digest_of(response);
    add(report, script_digest_);
    script_digest_.add(std::span<const std::uint64_t>(&now, 1));
    count(cycle, report);
    const char* const wrong = what_is_wrong(cycle, report, response, before == now);
    const bool overran = report.work > cycle.budget.work || report.work == std::numeric_limits<std::uint64_t>::max();
    result_.violations.work_overruns += overran ? 1 : 0;
    result_.violations.wrong_answers += wrong != nullptr && !overran ? 1 : 0;
    if (!result_.first_violation && result_.violations.sum() > violations) {
      result_.first_violation = {script_.kind, script_.cycles, wrong != nullptr ? wrong : "a call or fault in a step"};
    }
  }

  const char* what_is_wrong(const ElasticCycle& cycle, const StepReport& report, const Response& response,
                            bool unchanged) {
    const bool huge = script_.kind == ElasticScriptKind::huge;
    const Faults faults = faults_of(cycle, *view().info, options_.limits);
    const bool stepped = answered(report.status) || report.status == Status::held_overflow;
    // also where the report is wrong: the twin takes part in every step that moved the body
    const bool same = !stepped || twin_agrees(cycle, report, response);
    if (answered(report.status)) {
      tried_.follow(cycle);
      for (const Vec3& v : tried_.displacement) {
        script_.counts.farthest = std::max(script_.counts.farthest, static_cast<double>(std::hypot(v.x, v.y, v.z)));
      }
    }
    if (report.work > cycle.budget.work) return "a step took more than its budget";
    if (!may_be(report.status, cycle, faults, huge, tried_.need)) {
      if (report.status == Status::held_overflow) return "a state that is not finite, without any huge load";
      return answered(report.status) ? "a step was answered that should not be"
                                     : "a step was refused that should not be";
    }
    if (!answered(report.status) && !unchanged) return "a refused step changed the answer";
    if (answered(report.status) && !is_finite(response)) return "an answer is not finite";
    return same ? nullptr : "the body is not where one is that was never given what was refused";
  }

  bool twin_agrees(const ElasticCycle& cycle, const StepReport& report, const Response& response) {
    const Response twins = twin_.response(cycle);
    const StepReport other = twin_.body.step(inputs_of(cycle), cycle.budget, twins);
    return other.status == report.status && (!answered(report.status) || digest_of(twins) == digest_of(response));
  }

  void count(const ElasticCycle& cycle, const StepReport& report) {
    ElasticCounts& counts = script_.counts;
    ++counts.by_status[static_cast<std::size_t>(report.status)];
    if (!answered(report.status)) return;
    counts.spend(report.work, cycle.budget.work);
    counts.multigrid_cycles += report.cycles;
    counts.residual_sum += static_cast<double>(report.residual);
    counts.residual = std::max(counts.residual, static_cast<double>(report.residual));
  }

  const Model* model_;
  ElasticStressOptions options_;
  Body tried_, twin_;
  ScriptOutcome<ElasticScriptKind, ElasticCounts> script_;
  ElasticStressResult result_;
  FastDigest script_digest_, digest_;
  GuardedSteps guarded_{options_.fault};
};

ReportedStep reported(const ElasticCycle& cycle, const StepReport& report) {
  if (!answered(report.status)) return {"", report.work};
  std::string way = report.cycles == 0 ? "no cycle" : report.cycles == 1 ? "one cycle" : "more cycles";
  if (cycle.shown) way += ", shown";
  if (cycle.stress) way += ", stress";
  return {way, report.work};
}

}  // namespace

double ElasticCounts::mean_residual() const {
  return answers() > 0 ? residual_sum / static_cast<double>(answers()) : 0;
}

void ElasticCounts::add(const ElasticCounts& other) {
  StepCounts::add(other);
  multigrid_cycles += other.multigrid_cycles;
  residual_sum += other.residual_sum;
  residual = std::max(residual, other.residual);
  farthest = std::max(farthest, other.farthest);
}

ElasticStressResult run_elastic_stress(const Model& model, const ElasticStressOptions& options) {
  return ElasticStressRun(model, options).run();
}

std::vector<ReportedStep> run_elastic_plainly(const Model& model, const ElasticStressOptions& options) {
  Body body(model, options.limits);
  const MultigridView& view = model.view().multigrid;
  std::vector<ReportedStep> steps;
  const auto step = [&](const ElasticCycle& cycle) {
    const auto report = body.body.step(inputs_of(cycle), cycle.budget, body.response(cycle));
    if (answered(report.status)) body.follow(cycle);
    steps.push_back(reported(cycle, report));
  };
  visit_kinds(options, elastic_script_names, [&](ElasticScriptKind kind, std::uint64_t cycles) {
    body.renew();
    ElasticStressScript script(view, options.limits, body.need, kind, options.seed);
    for (std::uint64_t i = 0; i < cycles; ++i) {
      ElasticCycle cycle = script.next(body.displacement);
      if (options.budget > 0) cycle.budget.work = options.budget;
      step(cycle);
    }
  });
  body.renew();
  ElasticCycle heaviest;
  const auto& need = body.need;
  for (std::uint32_t i = 0; i < options.limits.max_loads; ++i) {
    heaviest.loads.push_back({i % view.info->free, {0, 0, 1e-3F}});
  }
  for (std::uint32_t i = 0; i < std::min(options.limits.max_holds, view.info->free / 20); ++i) {
    heaviest.holds.push_back({i, {}});
  }
  heaviest.shown = heaviest.stress = true;
  heaviest.budget.work = need.least_work + need.shown_work + need.stress_work + 8 * need.cycle_work;
  step(heaviest);
  return steps;
}

}  // namespace greenloop
