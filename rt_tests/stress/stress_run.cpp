#include "rt_tests/stress/stress_run.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

#include "rt_tests/harness/fast_digest.hpp"
#include "rt_tests/harness/loaded_driver.hpp"
#include "rt_tests/harness/time_of.hpp"
#include "rt_tests/stress/force_step.hpp"
#include "rt_tests/stress/guarded_steps.hpp"
#include "runtime/hosted/hosted.hpp"

namespace greenloop {
namespace {

constexpr std::uint64_t warm_up_cycles = 200;    // before the scripts: their pages are not of the loop
constexpr std::uint64_t progress_interval = 64;  // cycles

// without a branch on each, so that a whole field costs little
bool all_finite(std::span<const float> values) {
  bool finite = true;
  for (const float value : values) {
    finite &= (std::bit_cast<std::uint32_t>(value) & 0x7f800000) != 0x7f800000;
  }
  return finite;
}

template <Driver D>
class StressRun {
 public:
  StressRun(const Model& model, const StressOptions& options)
      : model_(&model),
        options_(options),
        host_(model, D::limits(options.contacts, options.factors, options.prices)),
        bounds_(D::bounds(host_.limits(), host_.requirement())) {
    result_.times = TimeHistogram(options.histogram_bins);
    result_.declared_work = bounds_.worst_work;
    result_.arena_bytes = host_.requirement().bytes;
  }

  StressResult run() {
    result_.watches_system_calls = guarded_.prepare();
    result_.create_ms = time_of(1, [this] { host_.renew(); }) / 1e3;
    warm_up();
    visit_scripts(options_, [this](ScriptKind kind, std::uint64_t cycles) { run_script(kind, cycles); });
    result_.digest = digest_.value();
    return result_;
  }

 private:
  using StepReport = typename D::Solver::StepReport;

  ContactScript script(ScriptKind kind) const { return script_of<D>(*model_, host_, kind, options_.seed); }

  StepReport step(const ScriptedStep& scripted) {
    return host_.step(scripted.contacts, scripted.budget, scripted.with_field);
  }

  void warm_up() {
    ContactScript script = this->script(ScriptKind::mixed);
    for (std::uint64_t i = 0; i < warm_up_cycles; ++i) {
      step(script.next());
    }
  }

  // on a body and buffers as in a run of this script alone
  void run_script(ScriptKind kind, std::uint64_t cycles) {
    ContactScript script = this->script(kind);
    host_.renew();
    hold_answer();
    force_step_.restart();
    last_ = {};
    script_ = {};
    script_.kind = kind;
    script_digest_ = {};
    for (; script_.cycles < cycles; ++script_.cycles, ++result_.cycles) {
      if (options_.progress && result_.cycles % progress_interval == 0) {
        options_.progress(kind, result_.cycles);
      }
      cycle(script.next());
    }
    script_.digest = script_digest_.value();
    result_.force_step_max = std::max(result_.force_step_max, script_.force_step_max);
    digest_.add(std::span<const std::uint64_t>(&script_.digest, 1));
    result_.scripts.push_back(script_);
  }

  void hold_answer() {
    held_force_.assign(host_.force_buffer().begin(), host_.force_buffer().end());
    held_field_.assign(host_.field().begin(), host_.field().end());
  }

  [[nodiscard]] bool answer_is_held() const {
    return std::memcmp(host_.field().data(), held_field_.data(), host_.field().size_bytes()) == 0 &&
           std::memcmp(host_.force_buffer().data(), held_force_.data(), host_.force_buffer().size_bytes()) == 0;
  }

  void cycle(const ScriptedStep& scripted) {
    const std::uint64_t violations = result_.violations.sum();
    const double begin = thread_microseconds();
    StepReport report;
    guarded_.run([&] { report = step(scripted); }, [&] { report.work += bounds_.worst_work; },
                 script_.cycles % GuardedSteps::fault_interval == GuardedSteps::fault_interval - 1, result_.violations);
    const double us = thread_microseconds() - begin;
    result_.times.add(us);
    script_.worst_us = std::max(script_.worst_us, us);
    const bool answered = greenloop::answered(report.status);
    check(scripted, report);
    D::count(report, last_, script_.counts);
    D::count(report, last_, result_.counts);
    last_ = report;
    note_digest(scripted, report);
    script_.force_step_max =
        std::max(script_.force_step_max, force_step_.follow(scripted.contacts, answered, host_.force()));
    if (answered) {
      hold_answer();
    }
    if (!result_.first_violation && result_.violations.sum() > violations) {
      result_.first_violation = {script_.kind, script_.cycles};
    }
  }

  void check(const ScriptedStep& scripted, const StepReport& report) {
    const bool answered = greenloop::answered(report.status);
    const std::uint64_t declared = answered ? D::declared_work(host_.requirement(), report) : bounds_.worst_work;
    result_.violations.work_overruns += report.work > scripted.budget || report.work > declared ? 1 : 0;
    const bool may_answer = scripted.budget >= bounds_.least_work;
    const bool right =
        answered ? may_answer && scripted.valid && all_finite(host_.force()) && all_finite(field_of(scripted))
                 : answer_is_held() && (!scripted.valid || !may_answer || report.status == Status::held_singular);
    result_.violations.wrong_answers += right ? 0 : 1;
  }

  // what the step was to write
  [[nodiscard]] std::span<const float> field_of(const ScriptedStep& scripted) const {
    return scripted.with_field ? host_.field() : std::span<const float>();
  }

  void note_digest(const ScriptedStep& scripted, const StepReport& report) {
    const auto facts = D::facts(report);
    script_digest_.add(std::span<const std::uint64_t>(facts));
    script_digest_.add(host_.force());
    script_digest_.add(field_of(scripted));
  }

  const Model* model_;
  StressOptions options_;
  Hosted<typename D::Solver> host_;
  ScriptBounds bounds_;
  std::vector<float> held_field_, held_force_;
  StepReport last_;
  ScriptResult script_;
  StressResult result_;
  FastDigest script_digest_, digest_;
  ForceStep force_step_;
  GuardedSteps guarded_{options_.fault};
};

}  // namespace

template <Driver D>
StressResult run_stress(const Model& model, const StressOptions& options) {
  return StressRun<D>(model, options).run();
}

template StressResult run_stress<ElastostaticDriver>(const Model&, const StressOptions&);
template StressResult run_stress<LoadedDriver>(const Model&, const StressOptions&);

}  // namespace greenloop
