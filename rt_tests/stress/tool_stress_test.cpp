#include "rt_tests/stress/tool_stress.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <set>

#include "runtime/testing/test_body.hpp"

namespace greenloop {
namespace {

const ToolScriptResult& result_of(const ToolStressResult& result, ToolScriptKind kind) {
  return *std::find_if(result.scripts.begin(), result.scripts.end(), [kind](auto& s) { return s.kind == kind; });
}

constexpr ToolStressOptions few{.cycles = 1200, .seed = 3, .contacts = 24, .iterations = 20};

TEST_CASE(
    "no script of tools makes a body spend more than declared, pull, leave a cone, allocate or enter the kernel") {
  for (const auto wavelet : {layout::Wavelet::lifted_linear, layout::Wavelet::equilibrated}) {
    const TestModel model({.levels = 4, .wavelet = wavelet, .touchable_above = -0.4});
    const ToolStressResult result = run_tool_stress(model.model(), few);
    CAPTURE(static_cast<int>(wavelet));
    if (result.first_violation) {
      MESSAGE(name(result.first_violation->script), " ", result.first_violation->cycle, ": ",
              result.first_violation->what);
    }
    CHECK(result.held());
    MESSAGE("finding contacts: declared ", result.declared.touching_work, ", worst ", result.counts.worst_touching,
            ", unfinished ", result.counts.unfinished);
    CHECK(result.declared.touching_work < 2 * result.counts.worst_touching);
    CHECK(result.counts.answers() > result.cycles / 2);
  }
}

TEST_CASE("every script of tools does what its name says") {
  const TestModel model({.levels = 4, .touchable_above = -0.4});
  const ToolStressResult result = run_tool_stress(model.model(), few);
  REQUIRE(result.scripts.size() == tool_script_names.size());
  std::set<std::uint64_t> digests;
  for (const ToolScriptResult& script : result.scripts) {
    CAPTURE(name(script.kind));
    digests.insert(script.digest);
    CHECK(script.cycles == 100);
    const bool is_refused = script.kind == ToolScriptKind::wander || script.kind == ToolScriptKind::starve ||
                            script.kind == ToolScriptKind::garbage;
    CHECK((script.counts.answers() < script.cycles) == is_refused);
    if (script.kind != ToolScriptKind::outside) CHECK(script.counts.contacts > 0);
  }
  CHECK(digests.size() == tool_script_names.size());
  CHECK(result_of(result, ToolScriptKind::garbage).counts.faults > 20);
  CHECK(result_of(result, ToolScriptKind::press).counts.slipping > 20);
  CHECK(result_of(result, ToolScriptKind::starve).counts.of(Status::held_over_budget) > 5);
  for (const Status status : {Status::held_not_finite, Status::held_out_of_range}) CHECK(result.counts.of(status) > 0);
}

TEST_CASE("tools: the same seed gives the same digest, alone as among others, and another seed another") {
  const TestModel model({.levels = 3});
  ToolStressOptions options = few;
  const ToolStressResult all = run_tool_stress(model.model(), options);
  options.script = ToolScriptKind::spin;
  options.cycles = 100;
  const ToolStressResult alone = run_tool_stress(model.model(), options);
  REQUIRE(alone.scripts.size() == 1);
  CHECK(alone.scripts[0].digest == result_of(all, ToolScriptKind::spin).digest);
  options.seed = 4;
  CHECK(run_tool_stress(model.model(), options).digest != alone.digest);
}

TEST_CASE("tools: a fault is seen, counted and can be met again") {
  const TestModel model({.levels = 2});
  for (const InjectedFault fault : {InjectedFault::allocation, InjectedFault::lock, InjectedFault::overrun}) {
    ToolStressReport report;
    report.model = "m.gloop";
    report.options = few;
    report.options.cycles = 100;
    report.options.script = ToolScriptKind::press;
    report.options.fault = fault;
    report.result = run_tool_stress(model.model(), report.options);
    const Violations& seen = report.result.violations;
    CHECK((fault == InjectedFault::allocation) == (seen.allocations > 0));
    CHECK((fault == InjectedFault::lock) == (seen.locks > 0));
    CHECK((fault == InjectedFault::overrun) == (seen.work_overruns > 0));
    CHECK(seen.wrong_answers == 0);
    CHECK(report.verdict() != "HELD");
    REQUIRE(report.result.first_violation);
    CHECK(report.result.first_violation->cycle == 99);
    CHECK(report.replay() ==
          "greenloop-stress m.gloop --tools --seed 3 --script press --cycles 100 --contacts 24 --factors 4");
    CHECK(report.json()["first_violation"]["script"] == "press");
  }
}

}  // namespace
}  // namespace greenloop
