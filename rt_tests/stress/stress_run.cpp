#include "rt_tests/stress/stress_run.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <ctime>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <vector>

#include "formats/aligned_bytes.hpp"
#include "rt_tests/stress/contact_script.hpp"
#include "sim_hw/guard/allocation_guard.hpp"
#include "sim_hw/guard/mutex_guard.hpp"
#include "sim_hw/guard/system_call_guard.hpp"

namespace greenloop {
namespace {

constexpr std::uint64_t warm_up = 100;  // cycles whose page faults do not count

double thread_microseconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) * 1e6 + static_cast<double>(time.tv_nsec) / 1e3;
}

std::uint64_t minor_faults() {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return static_cast<std::uint64_t>(usage.ru_minflt);
}

void add_time(TimeHistogram& times, double microseconds) {
  const auto bin = static_cast<std::size_t>(microseconds);
  ++(bin < TimeHistogram::bins ? times.count[bin] : times.overflow);
  times.least = times.total == 0 ? microseconds : std::min(times.least, microseconds);
  times.most = std::max(times.most, microseconds);
  times.total += microseconds;
}

std::uint64_t add_to_digest(std::uint64_t digest, const void* data, std::size_t bytes) {
  const auto* at = static_cast<const unsigned char*>(data);
  for (std::size_t i = 0; i < bytes; ++i) {
    digest = (digest ^ at[i]) * 0x100000001b3;
  }
  return digest;
}

bool all_finite(std::span<const float> values) {
  return std::all_of(values.begin(), values.end(), [](float value) { return std::isfinite(value); });
}

class StressRun {
 public:
  StressRun(const Model& model, const StressOptions& options)
      : options_(options),
        requirement_(Elastostatic::required(model, options.limits)),
        arena_(requirement_.bytes),
        field_memory_(std::size_t{16} * model.node_count()),
        field_(reinterpret_cast<float*>(field_memory_.data()), std::size_t{4} * model.node_count()),
        held_field_(field_.size()),
        force_(std::size_t{3} * (options.limits.max_contacts + 16)),
        held_force_(force_.size()),
        script_(model.view(), options.limits, requirement_, options.seed) {
    const auto created = Elastostatic::create(model, options.limits, {arena_.data(), arena_.size()});
    if (!created) {
      throw std::runtime_error("no body for this model with " + std::to_string(options.limits.max_contacts) +
                               " contacts and " + std::to_string(options.limits.cached_factors) +
                               " cached factors (error " + std::to_string(static_cast<int>(created.error)) + ")");
    }
    body_ = created.body;
    result_.digest = 0xcbf29ce484222325;
    result_.declared_work = *std::max_element(std::begin(requirement_.worst_work), std::end(requirement_.worst_work));
  }

  StressResult run() {
    {
      const std::lock_guard lock(mutex_);  // so that the guard has looked up the real function, which may allocate
    }
    const bool watches_system_calls = system_call_guard::install();
    const std::uint64_t allocations = allocation_guard::count();
    const std::uint64_t locks = mutex_guard::count();
    const std::uint64_t system_calls = system_call_guard::count();
    for (; result_.cycles < options_.cycles; ++result_.cycles) {
      cycle(script_.next());
    }
    result_.allocations = allocation_guard::count() - allocations;
    result_.locks = mutex_guard::count() - locks;
    result_.system_calls =
        watches_system_calls ? static_cast<std::int64_t>(system_call_guard::count() - system_calls) : -1;
    return result_;
  }

 private:
  void cycle(const ScriptedStep& scripted) {
    const std::span<float> force(force_.data(), 3 * scripted.contacts.size());
    const Response response{force, scripted.with_field ? field_ : std::span<float>()};
    std::copy(field_.begin(), field_.end(), held_field_.begin());
    std::copy(force_.begin(), force_.end(), held_force_.begin());
    const std::uint64_t faults = minor_faults();
    const double begin = thread_microseconds();
    const StepReport report = guarded_step(scripted, response);
    add_time(result_.times, thread_microseconds() - begin);
    result_.minor_faults += result_.cycles < warm_up ? 0 : minor_faults() - faults;
    check(scripted, report, force);
    note_force(scripted, report, force);
  }

  StepReport guarded_step(const ScriptedStep& scripted, const Response& response) {
    const bool faulty = result_.cycles % 100 == 99;
    allocation_guard::arm();
    mutex_guard::arm();
    system_call_guard::arm();
    StepReport report = body_.step(scripted.contacts, {scripted.budget}, response);
    if (faulty) {
      commit_fault(report);
    }
    system_call_guard::disarm();
    mutex_guard::disarm();
    allocation_guard::disarm();
    return report;
  }

  void commit_fault(StepReport& report) {
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
      case InjectedFault::overrun:
        report.work += result_.declared_work;
        break;
    }
  }

  void check(const ScriptedStep& scripted, const StepReport& report, std::span<const float> force) {
    const bool answered = report.status <= Status::coarser;
    const std::uint64_t declared = answered ? requirement_.worst_work[report.constraint_level] : result_.declared_work;
    result_.worst_work = std::max(result_.worst_work, report.work);
    result_.work_overruns += report.work > scripted.budget || report.work > declared ? 1 : 0;
    const bool held_in_place = std::memcmp(field_.data(), held_field_.data(), field_.size_bytes()) == 0 &&
                               std::memcmp(force_.data(), held_force_.data(), sizeof(float) * force_.size()) == 0;
    const bool may_answer = scripted.budget >= requirement_.least_work;
    const bool right =
        answered ? may_answer && scripted.valid && all_finite(force) && all_finite(field_)
                 : held_in_place && (!scripted.valid || !may_answer || report.status == Status::held_singular);
    result_.wrong_answers += right ? 0 : 1;
    result_.answered += answered ? 1 : 0;
    result_.coarser += report.status == Status::coarser ? 1 : 0;
    result_.refused += answered ? 0 : 1;
    result_.cached += report.cached_factor ? 1 : 0;
    result_.levels[report.constraint_level] += answered ? 1 : 0;
    const std::uint64_t facts[] = {static_cast<std::uint64_t>(report.status), report.constraint_level,
                                   report.field_level, report.work};
    result_.digest = add_to_digest(result_.digest, facts, sizeof facts);
    result_.digest = add_to_digest(result_.digest, force.data(), force.size_bytes());
    if (scripted.with_field && answered) {
      result_.digest = add_to_digest(result_.digest, field_.data(), field_.size_bytes());
    }
  }

  void note_force(const ScriptedStep& scripted, const StepReport& report, std::span<const float> force) {
    if (report.status > Status::coarser) {
      return;
    }
    double total[3] = {};
    for (std::size_t i = 0; i < force.size(); ++i) {
      total[i % 3] += double{force[i]};
    }
    if (scripted.smooth) {
      const double change = std::hypot(total[0] - total_[0], total[1] - total_[1], total[2] - total_[2]);
      result_.force_step_max = std::max(result_.force_step_max, change);
    }
    std::copy(std::begin(total), std::end(total), std::begin(total_));
  }

  StressOptions options_;
  Requirement requirement_;
  AlignedBytes arena_;
  AlignedBytes field_memory_;
  std::span<float> field_;
  std::vector<float> held_field_;
  std::vector<float> force_;
  std::vector<float> held_force_;
  ContactScript script_;
  Elastostatic body_;
  StressResult result_;
  double total_[3] = {};
  std::unique_ptr<int> leak_;
  std::mutex mutex_;
};

}  // namespace

StressResult run_stress(const Model& model, const StressOptions& options) { return StressRun(model, options).run(); }

}  // namespace greenloop
