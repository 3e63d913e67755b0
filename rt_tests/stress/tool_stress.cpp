#include "rt_tests/stress/tool_stress.hpp"

#include <algorithm>
#include <bit>
#include <stdexcept>

#include "formats/write/aligned_bytes.hpp"
#include "rt_tests/harness/fast_digest.hpp"
#include "rt_tests/harness/time_of.hpp"

namespace greenloop {
namespace {

constexpr std::uint64_t warm_up_cycles = 200;    // before the scripts: their pages are not of the loop
constexpr std::uint64_t progress_interval = 64;  // cycles

ContactBody::Limits limits_of(const ToolStressOptions& options) {
  ContactBody::Limits limits = TouchingScript::limits(options.contacts, options.iterations);
  limits.elastostatic.cached_factors = options.factors;
  limits.search_work = options.search_work;
  return limits;
}

void add(const Double3& v, FastDigest& digest) {
  const double numbers[3] = {v.x, v.y, v.z};
  digest.add(std::span<const double>(numbers));
}

std::uint64_t digest_of(const ContactBody& body) {
  FastDigest digest;
  digest.add(body.displacement());
  for (const ContactBody::ToolAnswer& tool : body.tools()) {
    const std::uint32_t facts[] = {static_cast<std::uint32_t>(tool.fault), tool.contacts};
    digest.add(std::span<const std::uint32_t>(facts));
    add(tool.force, digest);
    add(tool.torque, digest);
  }
  for (const ContactBody::Contact& contact : body.contacts()) {
    const std::uint32_t facts[] = {contact.node[0], contact.node[1], contact.node[2],
                                   static_cast<std::uint32_t>(contact.state)};
    digest.add(std::span<const std::uint32_t>(facts));
    add(contact.position, digest);
    add(contact.force, digest);
  }
  return digest.value();
}

void add(const ContactBody::StepReport& report, FastDigest& digest) {
  const std::uint64_t facts[] = {static_cast<std::uint64_t>(report.status),
                                 report.work,
                                 report.touching_work,
                                 report.constraint_level,
                                 report.iterations,
                                 std::bit_cast<std::uint32_t>(report.residual),
                                 report.left_out,
                                 report.unfinished};
  digest.add(std::span<const std::uint64_t>(facts));
}

void count(const ContactBody& body, const ContactBody::StepReport& report, ToolCounts& counts) {
  ++counts.by_status[static_cast<std::size_t>(report.status)];
  counts.left_out += report.left_out;
  counts.unfinished += report.unfinished;
  counts.worst_work = std::max(counts.worst_work, report.work);
  counts.worst_touching = std::max(counts.worst_touching, report.touching_work);
  if (!answered(report.status)) return;
  for (const ContactBody::ToolAnswer& tool : body.tools()) counts.faults += tool.fault != ToolFault::none ? 1 : 0;
}

class ToolStressRun {
 public:
  ToolStressRun(const Model& model, const ToolStressOptions& options)
      : model_(&model), options_(options), limits_(limits_of(options)) {
    result_.declared = ContactBody::required(model, limits_);
    if (result_.declared.bytes == 0) throw std::runtime_error("no body that tools touch for this model and limits");
    memory_ = AlignedBytes(result_.declared.bytes);
    result_.times = TimeHistogram(options.histogram_bins);
  }

  ToolStressResult run() {
    result_.watches_system_calls = guarded_.prepare();
    result_.create_ms = time_of(1, [this] { renew(); }) / 1e3;
    ToolScript script(*model_, result_.declared, ToolScriptKind::wander, options_.seed);
    for (std::uint64_t i = 0; i < warm_up_cycles; ++i) {
      const ToolScript::Cycle cycle = script.next(body_);
      static_cast<void>(body_.step(cycle.tools, {}, cycle.budget));
    }
    const std::size_t kinds = options_.script ? 1 : tool_script_names.size();
    for (std::size_t k = 0; k < kinds; ++k) {
      const std::uint64_t share = options_.cycles / kinds + (k < options_.cycles % kinds ? 1 : 0);
      run_script(options_.script.value_or(static_cast<ToolScriptKind>(k)), share);
    }
    result_.digest = digest_.value();
    return result_;
  }

 private:
  void renew() {
    const auto created = ContactBody::create(*model_, limits_, {memory_.data(), memory_.size()});
    if (!created) throw std::runtime_error("no body that tools touch for this model and limits");
    body_ = created.body;
  }

  // on a body as in a run of this script alone
  void run_script(ToolScriptKind kind, std::uint64_t cycles) {
    ToolScript script(*model_, result_.declared, kind, options_.seed);
    renew();
    last_ = digest_of(body_);
    script_ = {};
    script_.kind = kind;
    script_digest_ = {};
    for (; script_.cycles < cycles; ++script_.cycles, ++result_.cycles) {
      if (options_.progress && result_.cycles % progress_interval == 0) options_.progress(kind, result_.cycles);
      step(script.next(body_));
    }
    script_.digest = script_digest_.value();
    digest_.add(std::span<const std::uint64_t>(&script_.digest, 1));
    result_.scripts.push_back(script_);
  }

  void step(const ToolScript::Cycle& cycle) {
    const std::uint64_t before = result_.violations.sum();
    ContactBody::StepReport report;
    const double begin = thread_microseconds();
    guarded_.run([&] { report = body_.step(cycle.tools, {}, cycle.budget); },
                 [&] { report.work += result_.declared.worst_work; },
                 script_.cycles % GuardedSteps::fault_interval == GuardedSteps::fault_interval - 1, result_.violations);
    const double us = thread_microseconds() - begin;
    result_.times.add(us);
    script_.worst_us = std::max(script_.worst_us, us);
    const std::uint64_t now = digest_of(body_);
    const char* const wrong = check(cycle, report, now);
    add(report, script_digest_);
    script_digest_.add(std::span<const std::uint64_t>(&now, 1));
    last_ = now;
    count(body_, report, script_.counts);
    count(body_, report, result_.counts);
    if (!result_.first_violation && result_.violations.sum() > before) {
      result_.first_violation = {script_.kind, script_.cycles, wrong != nullptr ? wrong : "a call or fault in a step"};
    }
  }

  // what is wrong; null: nothing
  const char* check(const ToolScript::Cycle& cycle, const ContactBody::StepReport& report, std::uint64_t now) {
    const ContactBody::Requirement& declared = result_.declared;
    if (report.work > cycle.budget.work || report.work > declared.worst_work ||
        report.touching_work > body_.touching_work(cycle.tools) || report.touching_work > declared.touching_work) {
      ++result_.violations.work_overruns;
      return "a step took more than its budget, or than is declared";
    }
    const char* wrong = nullptr;
    if (!may_be(report.status, cycle, declared.least_work)) {
      wrong = "a step was refused that should not be";
    } else if (!answered(report.status)) {
      wrong = now != last_ ? "a refused step changed the answer" : nullptr;
    } else {
      wrong = check_touching(body_, cycle.tools, script_.counts);
      static_cast<void>(check_touching(body_, cycle.tools, result_.counts));
    }
    result_.violations.wrong_answers += wrong != nullptr ? 1 : 0;
    return wrong;
  }

  const Model* model_;
  ToolStressOptions options_;
  ContactBody::Limits limits_;
  AlignedBytes memory_;
  ContactBody body_;
  std::uint64_t last_ = 0;
  ToolScriptResult script_;
  ToolStressResult result_;
  FastDigest script_digest_, digest_;
  GuardedSteps guarded_{options_.fault};
};

}  // namespace

ToolStressResult run_tool_stress(const Model& model, const ToolStressOptions& options) {
  return ToolStressRun(model, options).run();
}

}  // namespace greenloop
