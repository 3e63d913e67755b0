#include "rt_tests/stress/impulse_stress.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <set>

#include "formats/testing/synthetic_motion.hpp"

namespace greenloop {
namespace {

ImpulseStressResult stress(const SyntheticMotion& motion, const ImpulseStressOptions& options) {
  const ModelFile file = encoded_file(synthetic_motion(motion));
  return run_impulse_stress(Model::open(file.bytes.span()).model, options);
}

const ScriptOutcome<ImpulseScriptKind, ImpulseCounts>& result_of(const ImpulseStressResult& result,
                                                                 ImpulseScriptKind kind) {
  return *std::find_if(result.scripts.begin(), result.scripts.end(), [kind](auto& s) { return s.kind == kind; });
}

TEST_CASE("no impulses make a body spend more than declared, answer garbage, allocate, lock or enter the kernel") {
  const SyntheticMotion motions[] = {
      {.alternating = true},
      {.vertices = 333, .modes = 12, .groups = 3, .planes = 2},
      {.vertices = 16, .modes = 2, .groups = 1, .impulses = 1, .orbits = 1},
      {.modes = 30, .groups = 3, .rows = 3, .time_step = 1.0F / 1000, .blend_rate = 0.5F},
      {.planes = 2, .impulses = 7, .orbits = 40, .alternating = true},
      {.vertices = 333, .modes = 12, .groups = 3, .alternating = true, .transfer_modes = 7},
      {.vertices = 17, .modes = 2, .groups = 1, .transfer_modes = 30}};
  std::uint64_t seed = 0;
  for (const SyntheticMotion& motion : motions) {
    CAPTURE(++seed);
    const ImpulseStressResult result = stress(motion, {.cycles = 7000, .seed = seed});
    CAPTURE(verdict_of(result.violations));
    CAPTURE((result.first_violation ? result.first_violation->what : "held"));
    CHECK(result.held());
    CHECK(result.cycles == 7000);
    CHECK(result.times.total() == 7000);
    CHECK(result.wrong_limits == 21);
    CHECK(result.counts.declared_over_worst() >= 1);
    CHECK(result.counts.declared_over_worst() <= 1.3);
    CHECK(result.counts.most_energy > 0);
    CHECK(result.counts.most_energy <= result.energy_bound);
  }
}

TEST_CASE("every script of impulses does what its name says") {
  const ImpulseStressResult result =
      stress({.vertices = 333, .planes = 2, .alternating = true}, {.cycles = 21003, .seed = 5});
  REQUIRE(result.scripts.size() == impulse_script_names.size());
  const auto counts = [&](ImpulseScriptKind kind) { return result_of(result, kind).counts; };
  const ImpulseCounts mixed = counts(ImpulseScriptKind::mixed), play = counts(ImpulseScriptKind::play),
                      storm = counts(ImpulseScriptKind::storm), garbage = counts(ImpulseScriptKind::garbage),
                      starve = counts(ImpulseScriptKind::starve), frames = counts(ImpulseScriptKind::frames),
                      paces = counts(ImpulseScriptKind::paces);
  CHECK(result_of(result, ImpulseScriptKind::mixed).cycles == 3001);
  CHECK(mixed.of(Status::coarser) > 0);
  for (const Status status : {Status::held_out_of_range, Status::held_illegal_impulse}) CHECK(play.of(status) > 0);
  CHECK(play.entered > 10);
  CHECK(play.continued > 0);
  CHECK(storm.entered == 3001);
  CHECK(storm.blending >= 2999);  // but for the first, which may begin where the rest does
  for (const Status status : {Status::held_out_of_range, Status::held_illegal_impulse, Status::held_response_size,
                              Status::held_over_budget}) {
    CHECK(garbage.of(status) > 50);
  }
  CHECK(garbage.answers() > 500);
  CHECK(starve.of(Status::held_over_budget) > 300);
  CHECK(starve.of(Status::coarser) > 300);
  CHECK(starve.of(Status::ok) > 300);
  CHECK(frames.of(Status::coarser) == 0);
  CHECK(frames.answers() > 2900);
  CHECK(paces.most_energy_share > storm.most_energy_share);
  CHECK(paces.continued > 0);
}

TEST_CASE("a script of impulses depends on its name and seed alone") {
  const SyntheticMotion motion = {.alternating = true};
  const ImpulseStressResult all = stress(motion, {.cycles = 2100, .seed = 3});
  std::set<std::uint64_t> digests;
  for (std::size_t k = 0; k < impulse_script_names.size(); ++k) {
    const auto kind = static_cast<ImpulseScriptKind>(k);
    const ImpulseStressResult alone = stress(motion, {.cycles = 300, .seed = 3, .script = kind});
    CAPTURE(name(kind));
    REQUIRE(alone.scripts.size() == 1);
    CHECK(alone.scripts[0].digest == result_of(all, kind).digest);
    CHECK(stress(motion, {.cycles = 300, .seed = 4, .script = kind}).digest != alone.digest);
    digests.insert(alone.digest);
  }
  CHECK(digests.size() == impulse_script_names.size());
  CHECK(stress(motion, {.cycles = 2100, .seed = 3}).digest == all.digest);
}

TEST_CASE("each fault in a step of impulses is seen") {
  const auto with = [](InjectedFault fault) {
    return stress({}, {.cycles = 400, .script = ImpulseScriptKind::play, .fault = fault});
  };
  CHECK(with(InjectedFault::none).held());
  CHECK(with(InjectedFault::allocation).violations.allocations >= 4);
  CHECK(with(InjectedFault::lock).violations.locks == 4);
  CHECK(with(InjectedFault::page_fault).violations.minor_faults == 4);
  const ImpulseStressResult called = with(InjectedFault::system_call);
  if (called.watches_system_calls) CHECK(called.violations.system_calls == 4);
  const ImpulseStressResult overrun = with(InjectedFault::overrun);
  CHECK(overrun.violations.work_overruns == 4);
  REQUIRE(overrun.first_violation);
  CHECK(overrun.first_violation->cycle == 99);
  CHECK(verdict_of(overrun.violations) == "VIOLATED: work_overruns 4");
}

TEST_CASE("a budget of every step is kept to") {
  const ImpulseStressResult refused = stress({}, {.cycles = 210, .budget = 1});
  CHECK(refused.held());
  CHECK(refused.counts.answers() == 0);
  CHECK(refused.counts.of(Status::held_over_budget) > 150);
}

TEST_CASE("no body can be made for limits that are none") {
  CHECK_THROWS_WITH(stress({}, {.cycles = 10, .limits = {.rate = -1}}),
                    "no body of motions for this model and these limits");
}

}  // namespace
}  // namespace greenloop
