// A step takes as many instructions whatever the displacements and whatever the numbers in the model, on every way the
// planner can take.
#include <doctest/doctest.h>

#include <algorithm>
#include <cfloat>
#include <string>
#include <utility>
#include <vector>

#include "rt_tests/instructions/counted.hpp"
#include "runtime/testing/test_body.hpp"

namespace greenloop {
namespace {

std::vector<Constraint> contacts(const std::vector<std::uint32_t>& nodes, float value) {
  std::vector<Constraint> result(nodes.size());
  std::transform(nodes.begin(), nodes.end(), result.begin(), [value](std::uint32_t node) {
    return Constraint{node, {value, -value, value}};
  });
  return result;
}

// a step after others of a new body
struct Way {
  std::string name;
  std::vector<std::uint32_t> before;  // nodes held in the step before; none: there is none
  std::vector<std::uint32_t> nodes;
  std::uint64_t budget;
  bool with_field;
};

// instructions of the last step with contacts displaced by each value, and the reports
struct Outcome {
  std::vector<std::uint64_t> instructions;
  Elastostatic::StepReport report;
};

Outcome take(const Way& way, TestBody& body, std::initializer_list<float> values) {
  Outcome outcome;
  std::vector<std::vector<Constraint>> sets;
  for (const float value : values) {
    sets.push_back(contacts(way.nodes, value));
  }
  const auto prepare = [&] {
    body.renew();
    if (!way.before.empty()) {
      body.step(contacts(way.before, 1e-3F), any_budget, true);
    }
  };
  const auto step = [&](std::size_t i) { outcome.report = body.step(sets[i], way.budget, way.with_field); };
  prepare();
  step(0);  // every library function has been called before
  outcome.instructions = count_each(sets.size(), prepare, step);
  return outcome;
}

// the work of a step that is not limited, and the greatest budget below it that still is answered
std::uint64_t budget_below(TestBody& body, const std::vector<std::uint32_t>& nodes) {
  body.renew();
  return body.step(contacts(nodes, 1e-3F), any_budget, true).work - 1;
}

// those of a patch, from `first` on
std::vector<std::uint32_t> nodes_of(const TestModel& model, std::size_t first, std::size_t count) {
  const auto nodes = model.touchable();
  std::vector<std::uint32_t> result;
  for (std::size_t i = 0; i < count; ++i) {
    result.push_back(nodes[first + i]);
  }
  return result;
}

std::vector<Way> ways(const TestModel& model, TestBody& body, std::size_t contacts) {
  const auto patch = nodes_of(model, 0, contacts), moved = nodes_of(model, 1, contacts);
  return {{"released", patch, {}, any_budget, true},
          {"cached", patch, patch, any_budget, true},
          {"cached, forces only", patch, patch, any_budget, false},
          {"changed", patch, moved, any_budget, true},
          {"fresh", {}, patch, any_budget, true},
          {"fresh, forces only", {}, patch, any_budget, false},
          {"coarser", {}, patch, budget_below(body, patch), true}};
}

void check_way(const Way& way, const Elastostatic::StepReport& report, std::uint32_t finest) {
  const std::string& name = way.name;
  const bool fine = report.constraint_level == finest && report.field_level == finest;
  CHECK(report.status == (fine ? Status::ok : Status::coarser));
  CHECK((name.find("cached") == 0) == report.details.cached_factor);
  CHECK((name == "changed") == (report.details.changed_nodes > 0));
  CHECK((name.find("coarse") == 0) == (report.constraint_level < finest));
  CHECK((name == "coarsest, field cut") == (report.field_level < finest));
}

void compare(const Way& way, const TestModel& model, TestBody& body) {
  CAPTURE(way.name);
  const Outcome outcome = take(way, body, {1e-3F, 0.0F, FLT_TRUE_MIN});
  MESSAGE(way.name, ", ", way.nodes.size(), " contacts: ", outcome.instructions[0], " instructions");
  check_way(way, outcome.report, model.model().level_count() - 1);
  CHECK(all_equal(outcome.instructions));
}

TEST_CASE("on every way of the planner a step takes the same instructions whatever the displacements") {
  if (!instruction_counter::install()) {
    MESSAGE("instructions cannot be counted on this processor; nothing is compared");
    return;
  }
  // a patch so large that changing a factor is less work than a fresh one
  const std::pair<SyntheticOptions, std::uint32_t> patches[] = {
      {{.levels = 2}, 4},
      {{.levels = 3, .wavelet = layout::Wavelet::butterfly}, 6},
      {{.levels = 3, .wavelet = layout::Wavelet::equilibrated}, 6}};
  for (const auto& [synthetic, contacts] : patches) {
    const TestModel model(synthetic);
    TestBody body(model, {.max_contacts = contacts, .cached_factors = 2});
    for (const Way& way : ways(model, body, contacts)) {
      compare(way, model, body);
    }
  }
}

TEST_CASE("a step that cuts the field takes the same instructions whatever the displacements") {
  if (!instruction_counter::install()) {
    return;
  }
  // the field of one node is dear beside its forces
  const TestModel model({.levels = 3});
  TestBody body(model, {.max_contacts = 1, .cached_factors = 1});
  compare({"coarsest, field cut", {}, {model.touchable().back()}, body.requirement().least_work, true}, model, body);
}

// the same structure with other numbers in the couplings and predictions
TestModel with_numbers(const SyntheticOptions& synthetic, std::int16_t value) {
  ModelData data = synthetic_model(synthetic);
  for (LevelData& level : data.levels) {
    std::fill(level.predictions.weight.begin(), level.predictions.weight.end(), value);
    for (CouplingsData& couplings : level.couplings) {
      std::fill(couplings.value.begin(), couplings.value.end(), value);
    }
  }
  return TestModel(encode(data));
}

TEST_CASE("forces take the same instructions whatever the numbers in the model") {
  if (!instruction_counter::install()) {
    return;
  }
  const std::pair<SyntheticOptions, std::uint32_t> patches[] = {
      {{.levels = 2}, 4}, {{.levels = 3, .wavelet = layout::Wavelet::equilibrated}, 6}};
  for (const auto& [synthetic, contacts] : patches) {
    std::vector<std::vector<std::uint64_t>> counts(3);
    // copies take a few instructions more or less by where they lie: every body lies in the same memory
    TestModel model = with_numbers(synthetic, 0);
    TestBody body(model, {.max_contacts = contacts, .cached_factors = 2});
    for (const std::int16_t value : std::initializer_list<std::int16_t>{0, 1, -1}) {
      model = with_numbers(synthetic, value);
      const auto patch = nodes_of(model, 0, contacts), moved = nodes_of(model, 1, contacts);
      const Way of_forces[] = {{"cached", patch, patch, any_budget, false},
                               {"changed", patch, moved, any_budget, false},
                               {"fresh", {}, patch, any_budget, false}};
      for (std::size_t i = 0; i < std::size(of_forces); ++i) {
        CAPTURE(of_forces[i].name);
        const Outcome outcome = take(of_forces[i], body, {1e-3F});
        check_way(of_forces[i], outcome.report, model.model().level_count() - 1);
        counts[i].push_back(outcome.instructions[0]);
      }
    }
    for (const auto& of_way : counts) {
      CHECK(all_equal(of_way));
      CHECK(of_way[0] > 100);
    }
  }
}

}  // namespace
}  // namespace greenloop
