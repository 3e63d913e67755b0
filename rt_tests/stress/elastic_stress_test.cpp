// The stress run of multigrid models: it holds, is the same in every run, and sees what is wrong.
#include "rt_tests/stress/elastic_stress.hpp"

#include <doctest/doctest.h>

#include "formats/testing/synthetic_multigrid.hpp"

namespace greenloop {
namespace {

struct Beam {
  explicit Beam(layout::Strain strain = layout::Strain::corotational)
      : file(encoded_file(synthetic_multigrid({.cells = 4, .strain = strain}))) {}
  ModelFile file;
  Model model = Model::open(file.bytes.span()).model;
};

TEST_CASE("loads and holds on a multigrid model: nothing is violated, whatever the strain") {
  for (const layout::Strain strain : {layout::Strain::linear, layout::Strain::corotational, layout::Strain::green}) {
    CAPTURE(static_cast<int>(strain));
    const Beam beam(strain);
    const ElasticStressResult result = run_elastic_stress(beam.model, {.cycles = 12000});
    CAPTURE(result.first_violation.value_or(ScriptViolation<ElasticScriptKind>{}).what);
    CAPTURE(result.first_violation.value_or(ScriptViolation<ElasticScriptKind>{}).cycle);
    CHECK(result.held());
    CHECK(result.cycles == 12000);
    REQUIRE(result.scripts.size() == elastic_script_names.size());
    CHECK(result.counts.answers() > 8000);
    CHECK(result.counts.of(Status::held_over_budget) > 0);
    CHECK(result.counts.of(Status::held_not_finite) > 0);
    CHECK(result.counts.of(Status::held_out_of_range) > 0);
    CHECK(result.counts.of(Status::held_duplicate) > 0);
    CHECK(result.counts.of(Status::held_response_size) > 0);
    CHECK(result.counts.of(Status::held_overflow) > 0);
    CHECK(result.counts.worst_work <= result.counts.declared_work);
    CHECK(result.counts.declared_over_worst() < 2);
    CHECK(result.wrong_limits == 9);
  }
}

TEST_CASE("what is huge overflows, and the body goes on after it") {
  const Beam beam;
  const ElasticStressResult result =
      run_elastic_stress(beam.model, {.cycles = 4000, .script = ElasticScriptKind::huge});
  CHECK(result.held());
  CHECK(result.counts.of(Status::held_overflow) > 20);
  CHECK(result.counts.of(Status::coarser) + result.counts.of(Status::ok) > 3000);
}

TEST_CASE("a run of a multigrid model is the same again, and another by another seed") {
  const Beam beam;
  const auto digest = [&](std::uint64_t seed) {
    return run_elastic_stress(beam.model, {.cycles = 600, .seed = seed}).digest;
  };
  CHECK(digest(1) == digest(1));
  CHECK(digest(1) != digest(2));
}

TEST_CASE("faults in steps of a multigrid model are seen") {
  const Beam beam;
  const auto violations = [&](InjectedFault fault) {
    return run_elastic_stress(beam.model, {.cycles = 1200, .fault = fault}).violations;
  };
  CHECK(violations(InjectedFault::overrun).work_overruns == 12);
  CHECK(violations(InjectedFault::allocation).allocations > 0);
  CHECK(violations(InjectedFault::lock).locks > 0);
  CHECK(violations(InjectedFault::none).sum() == 0);
}

TEST_CASE("the report of a multigrid model has the keys of the others") {
  const Beam beam;
  ElasticStressReport report{.model = "beam.gloop", .options = {.cycles = 600}, .rate = 1000};
  report.result = run_elastic_stress(beam.model, report.options);
  report.time = judge_times(report.result.times, 1000, 1, false);
  const nlohmann::json json = report.json();
  CHECK(json["verdict"] == "HELD");
  for (const char* key : {"model",
                          "seed",
                          "rate",
                          "cycles",
                          "virtual_seconds",
                          "worst_work",
                          "declared_work",
                          "declared_over_worst",
                          "least_work",
                          "predicted_over_instructions",
                          "instructions_max",
                          "wrong_limits",
                          "time",
                          "time_verdict",
                          "digest",
                          "open_ms",
                          "create_ms",
                          "arena_bytes",
                          "histogram",
                          "scripts",
                          "first_violation",
                          "work_overruns",
                          "wrong_answers",
                          "allocations",
                          "locks",
                          "syscalls",
                          "minor_faults",
                          "statuses",
                          "multigrid"}) {
    CAPTURE(key);
    CHECK(json.contains(key));
  }
  CHECK(json["scripts"].size() == elastic_script_names.size());
  CHECK(json["multigrid"]["cycles"] > 0);
}

TEST_CASE("the plain steps are those of the run, and the heaviest") {
  const Beam beam;
  const auto steps = run_elastic_plainly(beam.model, {.cycles = 300});
  REQUIRE(steps.size() == 301);
  CHECK(steps.back().way.ends_with(", shown, stress"));
  CHECK(steps.back().work > 0);
}

}  // namespace
}  // namespace greenloop
