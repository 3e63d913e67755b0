#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <vector>

#include "runtime/testing/test_body.hpp"

namespace greenloop {
namespace {

constexpr std::uint32_t finest = 4;

TestModel wide_model() { return TestModel({.levels = finest + 1, .touchable_above = 0.3}); }

double distance(std::span<const float> a, std::span<const float> b) {
  double sum = 0;
  double norm = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    sum += std::pow(double{a[i]} - b[i], 2);
    norm += std::pow(double{b[i]}, 2);
  }
  return std::sqrt(sum / norm);
}

struct Slide {
  double error = 0;  ///< of the forces, against the finest level, a mean
  std::uint32_t finest = 0;
  std::uint64_t digest = empty_hash;
};

// a patch that moves on by a node in every step
Slide slide(const TestModel& model, std::uint64_t budget, std::uint64_t refining_work, std::uint32_t steps) {
  TestBody body(model, {.max_contacts = 32, .refining_work = refining_work});
  TestBody exact(model, {.max_contacts = 32, .glide_cycles = 1});
  Slide result;
  for (std::uint32_t step = 0; step < steps; ++step) {
    const auto contacts = patch(model, step, 32);
    REQUIRE(exact.step(contacts, any_budget).status == Status::ok);
    const Elastostatic::StepReport report = body.step(contacts, budget);
    REQUIRE(answered(report.status));
    CHECK(report.work <= budget);
    CHECK(report.work <= body.requirement().worst_work[report.constraint_level]);
    result.finest += report.constraint_level == finest ? 1 : 0;
    result.error += distance(body.force(), exact.force()) / steps;
    result.digest = hash_step(result.digest, report, body.force(), body.field());
  }
  return result;
}

TEST_CASE("a patch with one new contact in every step reaches the finest level and stays there") {
  const TestModel model = wide_model();
  const std::uint64_t whole =
      TestBody(model, {.max_contacts = 32}).step(patch(model, 0, 32), any_budget).details.needed_work;
  std::map<std::uint64_t, double> error;
  for (const std::uint64_t percent : {80U, 60U, 50U, 45U}) {
    const std::uint64_t budget = whole * percent / 100;
    const Slide prepared = slide(model, budget, ~std::uint64_t{0}, 40);
    const Slide coarse = slide(model, budget, 1, 40);
    MESSAGE("budget of ", percent, " %: ", prepared.finest, " of 40 steps at the finest level; mean force error ",
            prepared.error, ", without slices ", coarse.error);
    CHECK(prepared.finest > 20);
    CHECK(coarse.finest == 0);
    CHECK(prepared.error < coarse.error);
    CHECK(slide(model, budget, ~std::uint64_t{0}, 40).digest == prepared.digest);
    error[percent] = prepared.error;
  }
  CHECK(error[60] <= 0.05);
}

// a pressed patch that slides on by a node in 16 steps: the last contact comes from where the others leave its node to
// where it is pressed, the first one goes the other way, so that the finest level's forces change little from step to
// step
std::vector<std::vector<Constraint>> sliding_press(const TestModel& model, std::uint32_t nodes) {
  constexpr std::uint32_t held = 16, steps_of_node = 16;
  TestBody body(model, {.max_contacts = held});
  std::vector<std::vector<Constraint>> contacts;
  for (std::uint32_t step = 0; step < steps_of_node * nodes; ++step) {
    auto now = patch(model, step / steps_of_node, held);
    for (Constraint& contact : now) {
      std::copy_n(std::array{0.0F, 0.0F, -1e-3F}.begin(), 3, contact.value);
    }
    body.step(std::span(now).subspan(1, held - 2), any_budget);
    const float share = static_cast<float>(step % steps_of_node) / steps_of_node;
    for (std::size_t r = 0; r < 3; ++r) {
      const auto left_at = [&](const Constraint& contact) { return body.field()[std::size_t{4} * contact.node + r]; };
      now.front().value[r] += share * (left_at(now.front()) - now.front().value[r]);
      now.back().value[r] += (1 - share) * (left_at(now.back()) - now.back().value[r]);
    }
    contacts.push_back(now);
  }
  return contacts;
}

struct ForceSteps {
  double largest = 0;  ///< N, of the total force
  double mean = 0;     ///< N, total force
  std::uint64_t worst_work = 0;
};

ForceSteps force_steps(const TestModel& model, const std::vector<std::vector<Constraint>>& contacts,
                       std::uint64_t budget) {
  TestBody body(model, {.max_contacts = 16});
  ForceSteps steps;
  std::array<double, 3> last{};
  for (std::size_t step = 0; step < contacts.size(); ++step) {
    const Elastostatic::StepReport report = body.step(contacts[step], budget, false);
    REQUIRE(answered(report.status));
    steps.worst_work = std::max(steps.worst_work, report.work);
    std::array<double, 3> total{};
    for (std::size_t i = 0; i < body.force().size(); ++i) {
      total[i % 3] += double{body.force()[i]};
    }
    steps.mean += std::hypot(total[0], total[1], total[2]) / static_cast<double>(contacts.size());
    if (step > 0) {
      steps.largest = std::max(steps.largest, std::hypot(total[0] - last[0], total[1] - last[1], total[2] - last[2]));
    }
    last = total;
  }
  return steps;
}

TEST_CASE(
    "where a pressed patch slides, a starved body's force steps a tenth of it beyond the finest level's at most") {
  const TestModel model({.levels = 4});
  const auto contacts = sliding_press(model, 20);
  const ForceSteps whole = force_steps(model, contacts, any_budget);
  for (const std::uint64_t part : {10U, 4U, 2U}) {
    const ForceSteps starved = force_steps(model, contacts, whole.worst_work / part);
    MESSAGE("largest step of the total force over its mean: ", starved.largest / whole.mean, " at 1/", part,
            " of the work, at the finest level ", whole.largest / whole.mean);
    CHECK(starved.largest <= whole.largest + 0.1 * whole.mean);
  }
}

// a patch at the finest level, and a budget that holds its cached factor but not the change of a node
struct Pressed {
  TestModel model = wide_model();
  TestBody body;
  std::uint64_t budget = 0;

  explicit Pressed(const Elastostatic::Limits& limits = {.max_contacts = 32}) : body(model, limits) {
    body.step(patch(model, 0, 32), any_budget);
    budget = body.step(patch(model, 0, 32), any_budget).details.needed_work + 1000000;
  }
};

TEST_CASE("a new contact waits while the others are held at the finest level, and is held soon") {
  Pressed pressed;
  TestBody exact(pressed.model, {.max_contacts = 32});
  const auto contacts = patch(pressed.model, 1, 32);
  std::vector<Constraint> others(contacts.begin(), contacts.end() - 1);
  std::uint32_t steps = 0;
  Elastostatic::StepReport report;
  for (;; ++steps) {
    REQUIRE(steps < 15);
    report = pressed.body.step(contacts, pressed.budget);
    REQUIRE(report.constraint_level == finest);
    CHECK(report.work <= pressed.budget);
    CHECK(report.status == Status::coarser);
    if (report.details.waiting_contacts == 0) {
      break;
    }
    CHECK(report.details.waiting_contacts == 1);
    CHECK(report.details.held_contacts == 31);
    CHECK(std::isinf(report.error));
    exact.step(others, any_budget);
    CHECK(distance(pressed.body.force().first(93), exact.force()) <= 1e-4);
    CHECK(distance(pressed.body.field(), exact.field()) <= 1e-4);
    for (std::size_t r = 93; r < 96; ++r) {
      CHECK(pressed.body.force()[r] == 0);
    }
  }
  CHECK(steps > 0);
  MESSAGE("held after ", steps, " steps");
  // then it comes in by quarters
  const std::vector<float> without(exact.force().begin(), exact.force().end());
  exact.step(contacts, any_budget);
  for (float share = 0.25F; share <= 1; share += 0.25F) {
    CHECK(report.details.glide == share);
    std::vector<float> expected(exact.force().begin(), exact.force().end());
    for (std::size_t i = 0; i < expected.size(); ++i) {
      expected[i] = share * expected[i] + (1 - share) * (i < without.size() ? without[i] : 0);
    }
    CHECK(distance(pressed.body.force(), expected) <= 1e-4);
    CHECK((report.status == Status::ok) == (share == 1));
    report = pressed.body.step(contacts, pressed.budget);
  }
  CHECK(report.details.glide == 1);
}

TEST_CASE("no contact waits where forces switch at once, where nothing is prepared, or if many are new") {
  const auto waits = [](Pressed&& pressed, std::size_t first) {
    const Elastostatic::StepReport report = pressed.body.step(patch(pressed.model, first, 32), pressed.budget);
    CHECK(report.constraint_level < finest + (report.details.waiting_contacts > 0 ? 1 : 0));
    return report.details.waiting_contacts;
  };
  CHECK(waits(Pressed{}, 1) == 1);
  CHECK(waits(Pressed{}, 8) == 8);
  CHECK(waits(Pressed{}, 9) == 0);
  CHECK(waits(Pressed{{.max_contacts = 32, .glide_cycles = 1}}, 1) == 0);
  CHECK(waits(Pressed{{.max_contacts = 32, .refining_work = 1}}, 1) == 0);
}

TEST_CASE("only new contacts wait, for less steps than a glide takes") {
  const TestModel model = wide_model();
  const Elastostatic::Limits limits{.max_contacts = 32, .cached_factors = 3, .glide_cycles = 3};
  TestBody body(model, limits);
  const std::uint64_t whole = TestBody(model, limits).step(patch(model, 0, 32), any_budget).details.needed_work;
  std::mt19937_64 random(4);
  std::map<std::uint32_t, std::uint32_t> waited;  // by node, of the last step
  std::size_t first = 0;
  std::uint32_t waiting = 0, given_up = 0;
  for (int step = 0; step < 1500; ++step) {
    first += random() % 4 == 0 ? random() % 4 : 0;
    const auto contacts = patch(model, first, 24 + random() % 2);
    const std::uint64_t budget = std::max(body.requirement().least_work, whole / (2 + random() % 8));
    const Elastostatic::StepReport report = body.step(contacts, budget, random() % 4 == 0);
    REQUIRE(answered(report.status));
    CHECK(report.work <= budget);
    CHECK(report.work <= body.requirement().worst_work[report.constraint_level]);
    std::map<std::uint32_t, std::uint32_t> now;
    std::uint32_t without_force = 0;
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      const float* force = body.force().data() + 3 * i;
      const bool waits = force[0] == 0 && force[1] == 0 && force[2] == 0;
      const auto before = waited.find(contacts[i].node);
      if (waits) {
        CHECK((before == waited.end() || before->second > 0));
        ++without_force;
      }
      now[contacts[i].node] = waits ? (before == waited.end() ? 1 : before->second + 1) : 0;
      CHECK(now[contacts[i].node] < limits.glide_cycles);
      given_up += before != waited.end() && before->second + 1 == limits.glide_cycles && !waits ? 1 : 0;
    }
    CHECK(without_force == report.details.waiting_contacts);
    CHECK(report.details.held_contacts + without_force == contacts.size());
    CHECK(4 * std::size_t{report.details.waiting_contacts} <= contacts.size());
    waiting += report.details.waiting_contacts > 0 ? 1 : 0;
    waited = now;
  }
  MESSAGE(waiting, " of 1500 steps with contacts that wait; ", given_up, " that waited as long as they may");
  CHECK(waiting > 100);
  CHECK(given_up > 0);
}

}  // namespace
}  // namespace greenloop
