#include "runtime/elastostatic/loads.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "runtime/testing/dense_reference.hpp"
#include "runtime/testing/test_body.hpp"

namespace greenloop {
namespace {

using Kind = Constraint::Kind;

float uniform(std::mt19937_64& random) { return static_cast<float>(random() >> 40) * 0x1p-23F - 1.0F; }

// contacts, forces on other nodes and masks over any, in random order
struct Problem {
  Problem(const TestModel& model, std::mt19937_64& random, std::size_t holds, std::size_t forces,
          std::size_t patterns) {
    std::vector<std::uint32_t> nodes = model.touchable();
    std::shuffle(nodes.begin(), nodes.end(), random);
    for (std::size_t i = 0; i < std::min(holds + forces, nodes.size()); ++i) {
      constraints.push_back(draw(random, nodes[i], i < holds ? Kind::hold : Kind::force, i < holds ? 1e-3F : 1.0F));
    }
    masked_nodes.resize(patterns);
    weights.resize(patterns);
    for (std::size_t p = 0; p < patterns; ++p) {
      for (std::size_t k = 0; k < 5; ++k) {
        masked_nodes[p].push_back(nodes[random() % nodes.size()]);
        weights[p].push_back(0.2F);
      }
      masks.push_back({masked_nodes[p], weights[p]});
      constraints.push_back(draw(random, static_cast<std::uint32_t>(p), Kind::pattern, 1));
    }
    std::shuffle(constraints.begin(), constraints.end(), random);
  }

  static Constraint draw(std::mt19937_64& random, std::uint32_t node, Kind kind, float size) {
    return {node, {size * uniform(random), size * uniform(random), size * uniform(random)}, kind};
  }

  std::vector<Constraint> constraints;
  std::vector<std::vector<std::uint32_t>> masked_nodes;
  std::vector<std::vector<float>> weights;
  std::vector<Mask> masks;
};

double relative_error(std::span<const float> computed, std::size_t stride, const Eigen::VectorXd& reference) {
  double error = 0;
  for (Eigen::Index i = 0; i < reference.size(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    error = std::max(error, std::abs(computed[k / 3 * stride + k % 3] - reference(i)));
  }
  return error / reference.cwiseAbs().maxCoeff();
}

// float rounding of the matrix, the factors and the sums, amplified by the condition
double tolerance_of(const DenseAnswer& dense) { return 60 * dense.condition * 0x1p-24; }

constexpr Elastostatic::Limits limits{.max_contacts = 12, .cached_factors = 4, .max_forces = 24, .model_loads = true};

// of two pressures
SyntheticOptions loaded(std::uint32_t levels, layout::Wavelet kind) {
  return {.levels = levels, .wavelet = kind, .gravity = true, .pressures = 2};
}

TEST_CASE("contacts and known forces agree with a dense double-precision solution at every level") {
  for (const layout::Wavelet kind : layout::wavelets) {
    CAPTURE(static_cast<std::uint32_t>(kind));
    const ModelData data = synthetic_model(loaded(4, kind));
    const TestModel model(encode(data));
    const DenseReference reference(data);
    std::mt19937_64 random(3);
    std::uint32_t levels_seen = 0;
    for (int trial = 0; trial < 40; ++trial) {
      const Problem problem(model, random, static_cast<std::size_t>(trial) % 12, random() % 8, 1 + random() % 3);
      const float pressure[] = {1e3F * uniform(random), 1e3F * uniform(random)};
      Elastostatic::Loads loads{.masks = problem.masks, .stiffness = trial % 2 == 0 ? 1.0F : 3.7F};
      if (trial % 3 != 0) loads.gravity = {9.81F * uniform(random), 9.81F * uniform(random), 9.81F * uniform(random)};
      if (trial % 5 < 3) loads.pressure = std::span(pressure).first(static_cast<std::size_t>(trial) % 5);
      TestBody body(model, limits);
      Elastostatic::StepReport report = body.step(problem.constraints, loads, any_budget, true);
      const std::uint32_t wanted = static_cast<std::uint32_t>(trial) % model.view().levels;
      while (answered(report.status) && report.constraint_level > wanted &&
             report.work > body.requirement().least_work) {
        const std::uint64_t budget = std::max(report.work - report.work / 4, body.requirement().least_work);
        body.renew();
        report = body.step(problem.constraints, loads, budget, true);
      }
      REQUIRE(answered(report.status));
      levels_seen |= 1U << report.constraint_level;
      const DenseAnswer dense =
          solve_dense(model.view(), reference, report.constraint_level, problem.constraints, loads);
      CHECK(relative_error(body.force(), 3, dense.force) <= tolerance_of(dense));
      if (report.field_level + 1 == model.view().levels) {
        CHECK(relative_error(body.field(), 4, dense.displacement) <= tolerance_of(dense));
      }
    }
    CHECK(levels_seen > 1U << (model.view().levels - 1));  // the finest one, and a coarser one at least
  }
}

TEST_CASE("gravity alone bends the body, and needs no known forces") {
  const ModelData data = synthetic_model(loaded(4, layout::Wavelet::linear));
  const TestModel model(encode(data));
  const DenseReference reference(data);
  TestBody body(model, {.max_contacts = 4, .cached_factors = 2, .model_loads = true});
  const Elastostatic::Loads loads{.gravity = {0, 3, -9.81F}};
  const Elastostatic::StepReport report = body.step({}, loads, any_budget, true);
  CHECK(report.status == Status::ok);
  const DenseAnswer dense = solve_dense(model.view(), reference, 3, {}, loads);
  REQUIRE(dense.displacement.cwiseAbs().maxCoeff() > 0);
  CHECK(relative_error(body.field(), 4, dense.displacement) <= tolerance_of(dense));
  // a held body feels its weight, and without it stands as before
  const std::vector<Constraint> still = {{model.touchable()[7], {}}};
  REQUIRE(body.step(still, loads, any_budget, true).status == Status::ok);
  CHECK(relative_error(body.force(), 3, solve_dense(model.view(), reference, 3, still, loads).force) <=
        tolerance_of(dense));
  REQUIRE(body.step({}).status == Status::ok);
  CHECK(std::all_of(body.field().begin(), body.field().end(), [](float x) { return x == 0; }));
}

TEST_CASE("forces are the same without a field, and where no fields are made") {
  const TestModel model(loaded(4, layout::Wavelet::equilibrated));
  std::mt19937_64 random(4);
  Elastostatic::Limits alone = limits;
  alone.forces_only = true;
  TestBody body(model, limits), lean(model, alone);
  for (int trial = 0; trial < 20; ++trial) {
    const Problem problem(model, random, 5, 4, 2);
    const Elastostatic::Loads loads{.masks = problem.masks, .gravity = {0, 0, -9.81F}};
    REQUIRE(body.step(problem.constraints, loads, any_budget, true).status == Status::ok);
    const std::vector<float> with_field(body.force().begin(), body.force().end());
    REQUIRE(body.step(problem.constraints, loads, any_budget, false).status == Status::ok);
    REQUIRE(lean.step(problem.constraints, loads, any_budget, false).status == Status::ok);
    CHECK(std::equal(with_field.begin(), with_field.end(), body.force().begin()));
    CHECK(std::equal(with_field.begin(), with_field.end(), lean.force().begin()));
  }
}

TEST_CASE("the force of a known one is itself, and forces alone need no factor") {
  const TestModel model({.levels = 4});
  std::mt19937_64 random(6);
  TestBody body(model, limits);
  const Problem problem(model, random, 0, 6, 2);
  const Elastostatic::StepReport report = body.step(problem.constraints, {.masks = problem.masks}, any_budget, true);
  CHECK(report.status == Status::ok);
  CHECK(report.details.held_contacts == 0);
  CHECK(report.details.changed_nodes == 0);
  CHECK(report.work < body.step(patch(model, 0, 1), {}, any_budget, true).work + body.requirement().worst_work[3] / 2);
  body.step(problem.constraints, {.masks = problem.masks}, any_budget, true);
  for (std::size_t i = 0; i < problem.constraints.size(); ++i) {
    for (std::size_t r = 0; r < 3; ++r) CHECK(body.force()[3 * i + r] == problem.constraints[i].value[r]);
  }
}

TEST_CASE("contacts alone are answered as by a body that knows no forces") {
  const TestModel model({.levels = 4});
  TestBody with(model, limits);
  TestBody without(model, {.max_contacts = 12, .cached_factors = 4});
  CHECK(with.requirement().bytes > without.requirement().bytes);
  CHECK(with.requirement().least_work > without.requirement().least_work);
  for (std::size_t trial = 0; trial < 30; ++trial) {
    const auto contacts = patch(model, 3 * trial, 1 + trial % 12);
    const Elastostatic::StepReport report = with.step(contacts);
    const Prices prices;
    const std::uint64_t checked =
        check_loaded_work(prices, contacts.size(), 0) - check_contacts_work(prices, contacts.size());
    CHECK(report.work == without.step(contacts).work + checked);
    CHECK(std::equal(with.force().begin(), with.force().end(), without.force().begin()));
    CHECK(std::equal(with.field().begin(), with.field().end(), without.field().begin()));
  }
}

TEST_CASE("a stiffer body takes more force, and moves less under a known one") {
  const TestModel model({.levels = 3});
  TestBody soft(model, limits), stiff(model, limits);
  const auto contacts = patch(model, 0, 4);
  REQUIRE(soft.step(contacts).status == Status::ok);
  REQUIRE(stiff.step(contacts, {.stiffness = 4}, any_budget, true).status == Status::ok);
  for (std::size_t i = 0; i < soft.force().size(); ++i) CHECK(stiff.force()[i] == 4 * soft.force()[i]);
  CHECK(std::equal(soft.field().begin(), soft.field().end(), stiff.field().begin()));
  const std::vector<Constraint> pushed = {{contacts[0].node, {1, 2, 3}, Kind::force}};
  REQUIRE(soft.step(pushed).status == Status::ok);
  REQUIRE(stiff.step(pushed, {.stiffness = 4}, any_budget, true).status == Status::ok);
  for (std::size_t i = 0; i < soft.field().size(); ++i) CHECK(4 * stiff.field()[i] == soft.field()[i]);
}

TEST_CASE("any budget from the least on is held, and no step takes more than is declared") {
  for (const layout::Wavelet kind : {layout::Wavelet::linear, layout::Wavelet::equilibrated}) {
    const TestModel model(loaded(4, kind));
    for (const std::uint32_t forces : {0U, 1U, 24U}) {
      Elastostatic::Limits of_few = limits;
      of_few.max_forces = forces;
      of_few.model_loads = forces != 1;
      TestBody body(model, of_few);
      const Elastostatic::Requirement& need = body.requirement();
      std::mt19937_64 random(8);
      for (int trial = 0; trial < 400; ++trial) {
        const std::size_t patterns = forces > 1 ? random() % 3 : 0;
        const Problem problem(model, random, random() % 13, random() % (forces - 5 * patterns + 1), patterns);
        const std::uint64_t most = need.worst_work[model.view().levels - 1];
        const std::uint64_t budget = trial % 3 == 0 ? need.least_work : need.least_work + random() % most;
        const float pressure[] = {1, 2};
        Elastostatic::Loads loads{.masks = problem.masks};
        if (of_few.model_loads) loads = {.masks = problem.masks, .gravity = {1, 0, 0}, .pressure = pressure};
        const Elastostatic::StepReport report = body.step(problem.constraints, loads, budget, random() % 4 != 0);
        CAPTURE(trial);
        CHECK(answered(report.status));
        CHECK(report.work <= budget);
        CHECK(report.work <= need.worst_work[report.constraint_level]);
        CHECK(report.details.needed_work <= budget);
      }
    }
  }
}

TEST_CASE("under a load that stays slices reach the finest level, whose answer is that of any budget") {
  const TestModel model({.levels = 4});
  TestBody body(model, limits), rich(model, limits);
  auto constraints = patch(model, 0, 10);
  constraints.push_back({model.touchable().back(), {0.1F, 0, 0}, Kind::force});
  const std::uint64_t least = least_budget_of_finest(model, limits, patch(model, 0, 10), true);
  Elastostatic::StepReport report = body.step(constraints, {}, least * 3 / 4, true);
  CHECK(report.status == Status::coarser);
  for (int cycle = 0; cycle < 100 && report.status != Status::ok; ++cycle) {
    report = body.step(constraints, {}, least * 3 / 4, true);
  }
  REQUIRE(report.status == Status::ok);
  rich.step(constraints, {}, any_budget, true);
  for (std::size_t i = 0; i < rich.force().size(); ++i) {
    CHECK(body.force()[i] == doctest::Approx(rich.force()[i]).epsilon(1e-3));
  }
}

TEST_CASE("what is wrong with known forces is refused by name") {
  const TestModel model({.levels = 3, .touchable_above = 0.0});
  const std::vector<std::uint32_t> nodes = model.touchable();
  const std::uint32_t foreign = model.view().node_count;
  std::uint32_t untouchable = 0;
  while (model.model().is_touchable(untouchable)) ++untouchable;
  TestBody body(model, {.max_contacts = 2, .cached_factors = 1, .max_forces = 3});
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::uint32_t pair[] = {nodes[0], nodes[1]}, out[] = {nodes[0], foreign}, dry[] = {untouchable, nodes[0]};
  const float halves[] = {0.5F, 0.5F}, spoilt[] = {0.5F, nan};
  const std::uint32_t four[] = {nodes[0], nodes[1], nodes[2], nodes[3]};
  const float quarters[] = {0.25F, 0.25F, 0.25F, 0.25F};
  const Mask masks[] = {{pair, halves},  {out, halves}, {dry, halves}, {pair, spoilt}, {four, quarters}, {},
                        {pair, quarters}};
  const auto step = [&](std::vector<Constraint> constraints, float stiffness = 1) {
    return body.step(constraints, {.masks = masks, .stiffness = stiffness}, any_budget, true);
  };
  const Constraint force{nodes[0], {1, 0, 0}, Kind::force};
  const auto pattern = [](std::uint32_t mask) { return Constraint{mask, {1, 0, 0}, Kind::pattern}; };
  REQUIRE(step({force, pattern(0)}).status == Status::ok);
  const std::vector<float> before(body.field().begin(), body.field().end());
  const struct {
    std::vector<Constraint> constraints;
    Status status;
    std::uint32_t refused;
  } wrong[] = {
      {{{foreign, {1, 0, 0}, Kind::force}}, Status::held_out_of_range, 0},
      {{{untouchable, {1, 0, 0}, Kind::force}}, Status::held_not_touchable, 0},
      {{{nodes[0], {nan, 0, 0}, Kind::force}}, Status::held_not_finite, 0},
      {{force, force}, Status::held_duplicate, 1},
      {{force, {nodes[0], {}, Kind::hold}}, Status::held_duplicate, 1},
      {{force, {nodes[1], {}, Kind::normal}}, Status::held_unsupported, 1},
      {{{nodes[1], {}}, {nodes[2], {}}, {nodes[3], {}}}, Status::held_out_of_range, 2},
      {{{nodes[1], {}, Kind::force}, {nodes[2], {}, Kind::force}, pattern(0)}, Status::held_out_of_range, 2},
      {{pattern(7)}, Status::held_out_of_range, 0},
      {{pattern(1)}, Status::held_out_of_range, 0},
      {{pattern(2)}, Status::held_not_touchable, 0},
      {{pattern(3)}, Status::held_not_finite, 0},
      {{pattern(4)}, Status::held_out_of_range, 0},
      {{pattern(5)}, Status::held_out_of_range, 0},
      {{pattern(6)}, Status::held_out_of_range, 0},
      {{{0, {nan, 0, 0}, Kind::pattern}}, Status::held_not_finite, 0},
      {{{nodes[0], {1e38F, 1e38F, 1e38F}, Kind::force}}, Status::held_overflow, StepReport::no_constraint},
  };
  for (const auto& [constraints, status, refused] : wrong) {
    const Elastostatic::StepReport report = step(constraints);
    CHECK(report.status == status);
    CHECK(report.refused == refused);
  }
  CHECK(step({force}, nan).status == Status::held_not_finite);
  for (const float stiffness : {0.0F, -1.0F, 1e9F}) CHECK(step({force}, stiffness).status == Status::held_out_of_range);
  CHECK(std::equal(before.begin(), before.end(), body.field().begin()));
  CHECK(body.step({}, {.gravity = {0, 0, 1}}, any_budget, true).status == Status::held_unsupported);
  CHECK(body.step({}, {.pressure = halves}, any_budget, true).status == Status::held_unsupported);
  CHECK(body.step({}, {.gravity = {0, nan, 1}}, any_budget, true).status == Status::held_not_finite);
  TestBody holds(model, {.max_contacts = 2, .cached_factors = 1});
  CHECK(holds.step(std::vector<Constraint>{force}).status == Status::held_unsupported);
  CHECK(holds.step(std::vector<Constraint>{pattern(0)}).status == Status::held_unsupported);
}

TEST_CASE("what is wrong with loads of the model is refused by name") {
  const TestModel model(loaded(3, layout::Wavelet::linear));
  TestBody body(model, {.max_contacts = 2, .cached_factors = 1, .model_loads = true});
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float three[] = {1, 2, 3}, spoilt[] = {1, nan}, large[] = {1e38F};
  const auto status = [&](const Elastostatic::Loads& loads) { return body.step({}, loads, any_budget, true).status; };
  CHECK(status({.pressure = three}) == Status::held_out_of_range);
  CHECK(status({.pressure = spoilt}) == Status::held_not_finite);
  CHECK(status({.gravity = {1e38F, 0, 0}, .stiffness = 0x1p-20F}) == Status::held_overflow);
  CHECK(status({.pressure = large, .stiffness = 0x1p-20F}) == Status::held_overflow);
  CHECK(status({.gravity = {0, 0, -9.81F}, .pressure = std::span(three).first(2)}) == Status::ok);
  TestBody lean(model, {.max_contacts = 2, .cached_factors = 1});
  CHECK(lean.step({}, {.gravity = {0, 0, 1}}, any_budget, true).status == Status::held_unsupported);
}

}  // namespace
}  // namespace greenloop
