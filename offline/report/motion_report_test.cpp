#include "offline/report/motion_report.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <string>

#include "formats/testing/synthetic_motion.hpp"
#include "formats/testing/temporary_folder.hpp"
#include "offline/report/testing/message_of.hpp"

namespace greenloop::offline {
namespace {

const ModelFile& motions() {
  static const ModelFile file = encoded_file(synthetic_motion({.vertices = 120, .modes = 8, .groups = 2}));
  return file;
}

bool has(const Report& report, const std::string& part) { return report.html.find(part) != std::string::npos; }

bool draws(const Report& report, const std::string& name) {
  return std::any_of(report.figures.begin(), report.figures.end(), [&](const Figure& f) { return f.name == name; });
}

std::string trace_of(int cycles, int work, const std::string& status) {
  std::string text =
      "time,impulse,orbit,row,position,velocity,blend,distance,rank,truncation_error,work,budget,status\n";
  for (int i = 0; i < cycles; ++i) {
    text +=
        std::to_string(i * 1e-3) + ",-1,1,3,0.01,0.1,0.001,0,8,0.01," + std::to_string(work) + ",1000," + status + "\n";
  }
  return text;
}

TEST_CASE("a model of motions has a page: verdict, pictures, error against modes, size and impulses") {
  const Report report =
      make_motion_report(motions(), {.model = "strip.gloop", .trace = {}, .snapshot = {}, .build = {}});
  for (const char* name : {"frames", "rank", "size", "bytes"}) {
    CAPTURE(name);
    CHECK(draws(report, name));
  }
  CHECK_FALSE(draws(report, "run"));
  REQUIRE(report.missing.size() == 1);
  CHECK(report.missing[0].command.find("--script impulses --trace trace.csv") != std::string::npos);
  CHECK(report.figures.front().panels.size() == 3);  // one for each impulse
  for (const char* part : {"truncation error", "quantisation error", "120 vertices", "8 modes", "data:image/png;base64",
                           "no orbit was held out", "worst distance"}) {
    CAPTURE(part);
    CHECK(has(report, part));
  }
  CHECK(make_motion_report(motions(), {.model = "strip.gloop", .trace = {}, .snapshot = {}, .build = {}}).html ==
        report.html);
}

TEST_CASE("a model with an appearance is shown in light, one picture for each impulse") {
  const ModelFile lit = encoded_file(synthetic_motion({.vertices = 120, .modes = 8, .groups = 2, .transfer_modes = 3}));
  const ReportInputs inputs{.model = "strip.gloop", .trace = {}, .snapshot = {}, .build = {}};
  const Report report = make_motion_report(lit, inputs);
  REQUIRE(draws(report, "light"));
  CHECK(report.figures[1].panels.size() == 3);
  for (const char* part : {"In the evening sun", "by all 3 modes of the light", "light on states that it was not"}) {
    CAPTURE(part);
    CHECK(has(report, part));
  }
  CHECK_FALSE(draws(make_motion_report(motions(), inputs), "light"));
}

TEST_CASE("a run of impulses is drawn and judged") {
  const TemporaryFolder folder("motion_report");
  const auto with = [&](const std::string& text) {
    return make_motion_report(
        motions(), {.model = "strip.gloop", .trace = folder.write("trace.csv", text), .snapshot = {}, .build = {}});
  };
  const Report held = with(trace_of(50, 900, "ok"));
  CHECK(draws(held, "run"));
  CHECK(held.missing.empty());
  CHECK(has(held, "The run held its budget in every cycle."));
  CHECK(has(with(trace_of(50, 900, "held_illegal_impulse")), "The run held its budget in every cycle."));
  CHECK(has(with(trace_of(50, 1100, "ok")), "The run missed its budget."));
  CHECK(has(with(trace_of(50, 0, "held_over_budget")), "The run missed its budget."));
  CHECK(message_of([&] { (void)with("time,position\n0,1\n"); }).find("blend") != std::string::npos);
  CHECK(message_of([&] { (void)with(trace_of(0, 1, "ok")); }).find("no cycle") != std::string::npos);
}

TEST_CASE("records of other models are refused beside motions") {
  CHECK(message_of([] {
          (void)make_motion_report(motions(),
                                   {.model = "strip.gloop", .trace = {}, .snapshot = "snapshot.csv", .build = {}});
        }).find("snapshot.csv: of an elastostatic model") != std::string::npos);
}

}  // namespace
}  // namespace greenloop::offline
