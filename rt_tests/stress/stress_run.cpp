#include "rt_tests/stress/stress_run.hpp"

#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>

#include "formats/write/aligned_bytes.hpp"
#include "rt_tests/bench/thread_time.hpp"
#include "rt_tests/stress/force_step.hpp"
#include "sim_hw/guard/allocation_guard.hpp"
#include "sim_hw/guard/mutex_guard.hpp"
#include "sim_hw/guard/system_call_guard.hpp"

namespace greenloop {
namespace {

constexpr std::uint64_t warm_up_cycles = 200;    // before the scripts: their pages are not of the loop
constexpr std::uint64_t progress_interval = 64;  // cycles
constexpr std::uint64_t empty_digest = 0xcbf29ce484222325;

std::uint64_t minor_faults() {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return static_cast<std::uint64_t>(usage.ru_minflt);
}

std::uint64_t add_to_digest(std::uint64_t digest, const void* data, std::size_t bytes) {
  const auto* at = static_cast<const unsigned char*>(data);
  for (std::size_t i = 0; i < bytes; i += sizeof(std::uint64_t)) {
    std::uint64_t word = 0;
    std::memcpy(&word, at + i, std::min(sizeof word, bytes - i));
    digest = std::rotl(digest ^ word, 29) * 0x100000001b3;
  }
  return digest;
}

// without a branch on each, so that a whole field costs little
bool all_finite(std::span<const float> values) {
  bool finite = true;
  for (const float value : values) {
    finite &= (std::bit_cast<std::uint32_t>(value) & 0x7f800000) != 0x7f800000;
  }
  return finite;
}

class StressRun {
 public:
  StressRun(const Model& model, const StressOptions& options)
      : model_(&model),
        options_(options),
        requirement_(Elastostatic::required(model, options.limits)),
        arena_(requirement_.bytes),
        field_memory_(std::size_t{16} * model.node_count()),
        field_(reinterpret_cast<float*>(field_memory_.data()), std::size_t{4} * model.node_count()),
        held_field_(field_.begin(), field_.end()),
        force_(std::size_t{3} * (options.limits.max_contacts + 16)),
        held_force_(force_) {
    result_.times = TimeHistogram(options.histogram_bins);
    result_.declared_work = *std::max_element(std::begin(requirement_.worst_work), std::end(requirement_.worst_work));
    result_.arena_bytes = requirement_.bytes;
    result_.digest = empty_digest;
  }

  StressResult run() {
    {
      const std::lock_guard lock(mutex_);  // so that the guard has looked up the real function, which may allocate
    }
    result_.watches_system_calls = system_call_guard::install();
    warm_up();
    const std::size_t kinds = options_.script ? 1 : script_names.size();
    for (std::size_t k = 0; k < kinds; ++k) {
      const std::uint64_t share = options_.cycles / kinds + (k < options_.cycles % kinds ? 1 : 0);
      if (share > 0) {
        run_script(options_.script.value_or(static_cast<ScriptKind>(k)), share);
      }
    }
    return result_;
  }

 private:
  void create_body() {
    const double begin = bench::thread_microseconds();
    const auto created = Elastostatic::create(*model_, options_.limits, {arena_.data(), arena_.size()});
    result_.create_ms = (bench::thread_microseconds() - begin) / 1e3;
    if (!created) {
      throw std::runtime_error("no body for this model with " + std::to_string(options_.limits.max_contacts) +
                               " contacts and " + std::to_string(options_.limits.cached_factors) +
                               " cached factors (error " + std::to_string(static_cast<int>(created.error)) + ")");
    }
    body_ = created.body;
  }

  ContactScript script(ScriptKind kind) const {
    return {model_->view(), options_.limits, requirement_, kind, options_.seed};
  }

  void warm_up() {
    create_body();
    ContactScript script = this->script(ScriptKind::mixed);
    pristine_.assign(arena_.data(), arena_.data() + arena_.size());
    for (std::uint64_t i = 0; i < warm_up_cycles; ++i) {
      const ScriptedStep& scripted = script.next();
      body_.step(scripted.contacts, {scripted.budget}, response(scripted));
    }
  }

  // on a body and buffers as in a run of this script alone
  void run_script(ScriptKind kind, std::uint64_t cycles) {
    ContactScript script = this->script(kind);
    std::copy(pristine_.begin(), pristine_.end(), arena_.data());
    std::fill(field_.begin(), field_.end(), 0.0F);
    std::fill(force_.begin(), force_.end(), 0.0F);
    hold_answer();
    force_step_.restart();
    script_ = {.kind = kind, .digest = empty_digest};
    for (; script_.cycles < cycles; ++script_.cycles, ++result_.cycles) {
      if (options_.progress && result_.cycles % progress_interval == 0) {
        options_.progress(kind, result_.cycles);
      }
      cycle(script.next());
    }
    result_.worst_work = std::max(result_.worst_work, script_.worst_work);
    result_.force_step_max = std::max(result_.force_step_max, script_.force_step_max);
    result_.digest = add_to_digest(result_.digest, &script_.digest, sizeof script_.digest);
    result_.scripts.push_back(script_);
  }

  Elastostatic::Response response(const ScriptedStep& scripted) {
    return {std::span(force_).first(3 * scripted.contacts.size()), scripted.with_field ? field_ : std::span<float>()};
  }

  void hold_answer() {
    std::copy(field_.begin(), field_.end(), held_field_.begin());
    std::copy(force_.begin(), force_.end(), held_force_.begin());
  }

  void cycle(const ScriptedStep& scripted) {
    const Elastostatic::Response response = this->response(scripted);
    const std::uint64_t violations = result_.violations.sum();
    const double begin = bench::thread_microseconds();
    const Elastostatic::StepReport report = guarded_step(scripted, response);
    const double us = bench::thread_microseconds() - begin;
    result_.times.add(us);
    script_.worst_us = std::max(script_.worst_us, us);
    const bool answered = greenloop::answered(report.status);
    check(scripted, report, response);
    count(report);
    note_digest(report, response);
    script_.force_step_max =
        std::max(script_.force_step_max, force_step_.follow(scripted.contacts, answered, response.force));
    if (answered) {
      hold_answer();
    }
    if (!result_.first_violation && result_.violations.sum() > violations) {
      result_.first_violation = {script_.kind, script_.cycles};
    }
  }

  Elastostatic::StepReport guarded_step(const ScriptedStep& scripted, const Elastostatic::Response& response) {
    const bool faulty = script_.cycles % 100 == 99;
    if (faulty && options_.fault == InjectedFault::page_fault) {
      madvise(page_.get(), page_bytes_, MADV_DONTNEED);
    }
    const std::uint64_t allocations = allocation_guard::count(), locks = mutex_guard::count(),
                        system_calls = system_call_guard::count(), faults = minor_faults();
    allocation_guard::arm();
    mutex_guard::arm();
    system_call_guard::arm();
    Elastostatic::StepReport report = body_.step(scripted.contacts, {scripted.budget}, response);
    if (faulty) {
      commit_fault(report);
    }
    system_call_guard::disarm();
    mutex_guard::disarm();
    allocation_guard::disarm();
    Violations& violations = result_.violations;
    violations.minor_faults += minor_faults() - faults;
    violations.allocations += allocation_guard::count() - allocations;
    violations.locks += mutex_guard::count() - locks;
    violations.system_calls += system_call_guard::count() - system_calls;
    return report;
  }

  void commit_fault(Elastostatic::StepReport& report) {
    switch (options_.fault) {
      case InjectedFault::none:
        break;
      case InjectedFault::allocation:
        leak_.reset(new int(1));
        break;
      case InjectedFault::lock: {
        const std::lock_guard lock(mutex_);
        break;
      }
      case InjectedFault::system_call:
        static_cast<void>(getppid());
        break;
      case InjectedFault::page_fault:
        *static_cast<volatile char*>(page_.get()) = 1;
        break;
      case InjectedFault::overrun:
        report.work += result_.declared_work;
        break;
    }
  }

  void check(const ScriptedStep& scripted, const Elastostatic::StepReport& report,
             const Elastostatic::Response& response) {
    const bool answered = greenloop::answered(report.status);
    const std::uint64_t declared = answered ? requirement_.worst_work[report.constraint_level] : result_.declared_work;
    result_.violations.work_overruns += report.work > scripted.budget || report.work > declared ? 1 : 0;
    const bool may_answer = scripted.budget >= requirement_.least_work;
    bool right = false;
    if (answered) {
      right = may_answer && scripted.valid && all_finite(response.force) && all_finite(response.displacement);
    } else {
      const bool held_in_place = std::memcmp(field_.data(), held_field_.data(), field_.size_bytes()) == 0 &&
                                 std::memcmp(force_.data(), held_force_.data(), sizeof(float) * force_.size()) == 0;
      right = held_in_place && (!scripted.valid || !may_answer || report.status == Status::held_singular);
    }
    result_.violations.wrong_answers += right ? 0 : 1;
  }

  void count(const Elastostatic::StepReport& report) {
    const bool answered = greenloop::answered(report.status);
    ++result_.by_status[static_cast<std::size_t>(report.status)];
    ++(answered ? script_.answered : script_.refused);
    script_.coarser += report.status == Status::coarser ? 1 : 0;
    script_.cached += report.details.cached_factor ? 1 : 0;
    script_.mixed_levels += report.details.finer_level > report.constraint_level ? 1 : 0;
    script_.changed += report.details.changed_nodes > 0 ? 1 : 0;
    script_.worst_work = std::max(script_.worst_work, report.work);
    result_.levels[report.constraint_level] += answered ? 1 : 0;
  }

  void note_digest(const Elastostatic::StepReport& report, const Elastostatic::Response& response) {
    const std::uint64_t facts[] = {static_cast<std::uint64_t>(report.status),
                                   report.constraint_level,
                                   report.details.finer_level,
                                   report.details.finer_contacts,
                                   report.field_level,
                                   report.work};
    script_.digest = add_to_digest(script_.digest, facts, sizeof facts);
    script_.digest = add_to_digest(script_.digest, response.force.data(), response.force.size_bytes());
    script_.digest = add_to_digest(script_.digest, response.displacement.data(), response.displacement.size_bytes());
  }

  const Model* model_;
  StressOptions options_;
  Elastostatic::Requirement requirement_;
  AlignedBytes arena_;
  std::vector<std::byte> pristine_;  // the arena of a new body
  AlignedBytes field_memory_;
  std::span<float> field_;
  std::vector<float> held_field_;
  std::vector<float> force_;
  std::vector<float> held_force_;
  Elastostatic body_;
  ScriptResult script_;
  StressResult result_;
  ForceStep force_step_;
  std::unique_ptr<int> leak_;
  std::mutex mutex_;
  std::size_t page_bytes_ = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  std::unique_ptr<char, decltype(&std::free)> page_{static_cast<char*>(std::aligned_alloc(page_bytes_, page_bytes_)),
                                                    &std::free};
};

}  // namespace

StressResult run_stress(const Model& model, const StressOptions& options) { return StressRun(model, options).run(); }

}  // namespace greenloop
