#include "runtime/elastostatic/glide.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <vector>

#include "runtime/testing/test_body.hpp"

namespace greenloop {
namespace {

constexpr std::uint32_t cycles = 16;

// what each constraint level alone answers, and the budget with which a body that has cached nothing does so
struct LevelAnswer {
  std::vector<float> force;
  std::uint64_t budget = 0;
};
std::map<std::uint32_t, LevelAnswer> answers_of_levels(const TestModel& model, const Elastostatic::Limits& limits,
                                                       const std::vector<Constraint>& contacts) {
  std::map<std::uint32_t, LevelAnswer> answers;
  std::uint64_t budget = any_budget;
  while (true) {
    TestBody body(model, limits);
    const Elastostatic::StepReport report = body.step(contacts, budget);
    if (!answered(report.status)) {
      return answers;
    }
    answers.try_emplace(report.constraint_level, LevelAnswer{{body.force().begin(), body.force().end()}, report.work});
    budget = report.work - report.work / 32 - 1;
  }
}

double largest_difference(std::span<const float> a, std::span<const float> b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    largest = std::max(largest, std::abs(double{a[i]} - b[i]));
  }
  return largest;
}

double largest(std::span<const float> a) { return largest_difference(a, std::vector<float>(a.size())); }

double energy(const std::vector<Constraint>& contacts, std::span<const float> force) {
  double sum = 0;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    for (std::size_t r = 0; r < 3; ++r) {
      sum += double{contacts[i].value[r]} * force[3 * i + r] / 2;
    }
  }
  return sum;
}

// contacts so many that a budget can hold the cached finest level without the field, or a coarser one with it
struct Flapping {
  TestModel model{{.levels = 5, .touchable_above = 0.3}};
  std::vector<Constraint> contacts = patch(model, 3, 32);
  std::map<std::uint32_t, LevelAnswer> levels = answers_of_levels(model, limits(1), contacts);
  std::uint64_t cached = 0;  ///< work of the finest level with its factor

  static Elastostatic::Limits limits(std::uint32_t glide_cycles, std::uint32_t factors = 4) {
    return {.max_contacts = 32, .cached_factors = factors, .glide_cycles = glide_cycles};
  }

  Flapping() {
    REQUIRE(levels.size() == 5);
    TestBody body(model, limits(1));
    body.step(contacts, any_budget);
    cached = body.step(contacts, any_budget).work;
    REQUIRE(cached > body.requirement().least_work);
  }

  // a budget that is either plenty or makes the body answer at a coarser level
  std::uint64_t budget(std::mt19937_64& random, std::uint64_t least) const {
    return random() % 3 == 0 ? any_budget : least + random() % (cached - least);
  }
};

struct Steps {
  std::uint32_t changes = 0;      ///< of level
  double largest_difference = 0;  ///< of two levels
  double largest_step = 0;        ///< of a force from step to step
};

// the contacts are held while the budget flaps; every so often it stays, so that glides come to their end
Steps flap(const Flapping& flapping, const Elastostatic::Limits& limits) {
  TestBody body(flapping.model, limits);
  const std::uint64_t least = body.requirement().least_work;
  std::mt19937_64 random(3);
  Steps steps;
  std::vector<float> last;
  double start = 0;
  double switch_work = 0;
  std::uint32_t level = 0;
  std::uint64_t budget = any_budget;
  for (int step = 0; step < 1500; ++step) {
    budget = step % 100 < 60 ? flapping.budget(random, least) : budget;
    const Elastostatic::StepReport report = body.step(flapping.contacts, budget);
    REQUIRE(answered(report.status));
    CHECK(report.work <= budget);
    CHECK(report.work <= body.requirement().worst_work[report.constraint_level]);
    CHECK((report.status == Status::ok) ==
          (report.details.glide == 1 && report.constraint_level == 4 && report.field_level == 4));
    const double rounding = 1e-5 * largest(body.force());
    if (report.details.glide == 1) {
      CHECK(largest_difference(body.force(), flapping.levels.at(report.constraint_level).force) <= rounding);
    }
    if (step > 0) {
      const double change = largest_difference(body.force(), last);
      CHECK(change <= static_cast<double>(report.details.level_difference) / limits.glide_cycles + rounding);
      steps.largest_step = std::max(steps.largest_step, change);
      steps.changes += report.constraint_level != level ? 1 : 0;
      switch_work += report.details.switch_work;
    } else {
      start = energy(flapping.contacts, body.force());
    }
    level = report.constraint_level;
    last.assign(body.force().begin(), body.force().end());
    if (step % 100 == 99) {
      CHECK(report.details.glide == 1);
      // at rest the only work is that of the switches
      CHECK(switch_work - energy(flapping.contacts, body.force()) == doctest::Approx(-start).epsilon(1e-4));
    }
  }
  for (const auto& [c, one] : flapping.levels) {
    for (const auto& [d, other] : flapping.levels) {
      steps.largest_difference = std::max(steps.largest_difference, largest_difference(one.force, other.force));
    }
  }
  return steps;
}

TEST_CASE("a flapping budget moves the forces of held contacts by a sixteenth of the levels' difference at a time") {
  const Flapping flapping;
  for (const std::uint32_t factors : {1U, 2U, 4U}) {
    CAPTURE(factors);
    const Steps gliding = flap(flapping, Flapping::limits(cycles, factors));
    const Steps jumping = flap(flapping, Flapping::limits(1, factors));
    MESSAGE(gliding.changes, " changes of level; largest step ", gliding.largest_step, " N, without gliding ",
            jumping.largest_step, " N");
    CHECK(gliding.changes > 100);
    CHECK(gliding.largest_step <= gliding.largest_difference / cycles * (1 + 1e-4));
    CHECK(jumping.largest_step > gliding.largest_difference / 2);
  }
}

// two levels that every contact has a stiffness on, and what a glide makes of their forces
class TwoLevels {
 public:
  TwoLevels() {
    Arena counting;
    carve(counting);
    memory_ = AlignedBytes(static_cast<std::size_t>(counting.bytes()));
    Arena arena(memory_.data());
    carve(arena);
  }

  // N: symmetric and positive definite in the displacements
  static std::vector<float> forces(const std::vector<Constraint>& contacts, std::uint32_t level) {
    const float own = level == 0 ? 900 : 700;
    const float other = level == 0 ? 60 : 90;
    std::vector<float> force(3 * contacts.size());
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      for (std::size_t j = 0; j < contacts.size(); ++j) {
        const float stiffness = i == j ? own : other / (1 + std::abs(static_cast<float>(i) - static_cast<float>(j)));
        for (std::size_t r = 0; r < 3; ++r) {
          force[3 * i + r] += stiffness * contacts[j].value[r];
        }
      }
    }
    return force;
  }

  // the forces of the level before are known if `both_known`
  GlideReport step(const std::vector<Constraint>& contacts, std::uint32_t level, bool both_known) {
    force = forces(contacts, level);
    std::vector<std::uint32_t> places(contacts.size());
    std::vector<std::uint32_t> column{make_column(level, 0)};
    ContactSet set;
    set.columns = 1;
    set.column = column.data();
    set.place = places.data();
    glide.advance(contacts, set, last);
    const std::vector<float> older = forces(contacts, 1 - level);
    const GlideReport report =
        glide.blend(contacts, last, both_known && glide.follows() ? older.data() : nullptr, force.data());
    last.remember(contacts, set, force.data());
    return report;
  }

  Glide glide;
  LastAnswer last;
  std::vector<float> force;  ///< of the last step

 private:
  void carve(Arena& arena) {
    glide.carve(arena, 32, cycles);
    last.carve(arena, 32, 100);
  }

  AlignedBytes memory_;
};

std::vector<Constraint> row(std::uint32_t first, std::uint32_t count) {
  std::vector<Constraint> contacts;
  for (std::uint32_t node = first; node < first + count; ++node) {
    const auto u = static_cast<float>(1 + node % 5);
    contacts.push_back({node, {1e-4F * u, -2e-4F, 5e-5F * u}});
  }
  return contacts;
}

TEST_CASE("contacts that persist glide, those that join are answered by the new level, those that left are forgotten") {
  const auto before = row(0, 12);
  const auto after = row(2, 13);  // 10 of them persist
  TwoLevels body;
  CHECK(body.step(before, 1, false).share == 1);
  const std::vector<float> finest = body.force;
  const std::vector<float> coarser = TwoLevels::forces(after, 0);
  for (std::uint32_t step = 1; step <= cycles; ++step) {
    const float left = 1 - static_cast<float>(step) / cycles;
    CHECK(body.step(after, 0, false).share == 1 - left);
    std::vector<float> expected = coarser;
    for (std::size_t i = 0; i < 3 * std::size_t{10}; ++i) {
      expected[i] += left * (finest[i + 6] - expected[i]);
    }
    CHECK(largest_difference(body.force, expected) <= 1e-5 * largest(expected));
  }
  CHECK(body.step(after, 0, false).share == 1);
  CHECK(body.step(after, 0, false).difference == 0);
  // fewer than three quarters persist: forces change with the contacts, also in the middle of a glide
  CHECK(body.step(row(6, 13), 1, true).share == 1);
  CHECK(body.step(row(6, 13), 0, true).share < 1);
  CHECK(body.step(row(10, 13), 0, true).share == 1);
  CHECK(body.step(before, 0, true).share == 1);
  // a body that is let go, or held by other nodes, has nothing to glide from
  CHECK(body.step(before, 1, true).share < 1);
  body.last.release();
  CHECK(body.step(before, 1, true).share == 1);
  CHECK(body.step(row(40, 12), 0, true).share == 1);
  CHECK(body.step(before, 1, true).share == 1);
}

TEST_CASE("a glide that was foreseen begins with what the levels made of the same contacts") {
  const auto before = row(0, 12);
  const auto after = row(1, 12);
  TwoLevels body;
  body.step(before, 0, false);
  const std::vector<float> coarse = body.force;
  const std::vector<float> finer = TwoLevels::forces(before, 1);
  body.glide.foresee(1, body.last, finer.data());
  const std::vector<float> newest = TwoLevels::forces(after, 1);
  for (std::uint32_t step = 1; step <= cycles; ++step) {
    const float left = 1 - static_cast<float>(step) / cycles;
    CHECK(body.step(after, 1, false).share == 1 - left);
    std::vector<float> expected = newest;
    for (std::size_t i = 0; i < 3 * std::size_t{11}; ++i) {
      expected[i] += left * (coarse[i + 3] - finer[i + 3]);
    }
    CHECK(largest_difference(body.force, expected) <= 1e-5 * largest(expected));
  }
  // what was foreseen of a level is forgotten if another one answers
  body.glide.foresee(0, body.last, finer.data());
  body.step(after, 1, false);
  body.step(after, 0, false);
  const std::vector<float> coarser = TwoLevels::forces(after, 0);
  std::vector<float> expected = coarser;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    expected[i] += (1 - 1.0F / cycles) * (newest[i] - coarser[i]);
  }
  CHECK(largest_difference(body.force, expected) <= 1e-5 * largest(expected));
}

TEST_CASE("on a closed path with flapping levels the hand gets back what it gave and what the switches put in") {
  const auto contacts_at = [](int step) {
    auto contacts = row(0, 20);
    const double angle = 2 * std::acos(-1.0) * step / 1000;
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      for (std::size_t r = 0; r < 3; ++r) {
        const double along = 1 - std::cos(angle) + static_cast<double>((i + r) % 3) * std::sin(angle);
        contacts[i].value[r] *= static_cast<float>(along);
      }
    }
    return contacts;
  };
  TwoLevels body;
  std::mt19937_64 random(8);
  double hand = 0;
  double given = 0;
  double switches = 0;
  double share = 1;  // of the finer level
  std::uint32_t gliding = 0;
  auto contacts = contacts_at(0);
  body.step(contacts, 1, true);
  std::vector<float> force = body.force;
  for (int step = 1; step <= 1040; ++step) {
    const auto next = contacts_at(std::min(step, 1000));
    const std::uint32_t level = step > 1000 || random() % 20 < 10 ? 1 : 0;
    const GlideReport report = body.step(next, level, true);
    const double last_share = share;
    share = static_cast<double>(level == 1 ? report.share : 1 - report.share);
    const std::vector<float> coarse = TwoLevels::forces(next, 0);
    const std::vector<float> fine = TwoLevels::forces(next, 1);
    double work = 0;
    for (std::size_t i = 0; i < force.size(); ++i) {
      const double apart = double{fine[i]} - coarse[i];
      CHECK(body.force[i] == doctest::Approx(coarse[i] + share * apart).epsilon(1e-4).scale(0.1));
      // the hand moves first, then the share changes
      const double moved = body.force[i] - (share - last_share) * apart;
      work += (force[i] + moved) / 2 * (double{next[i / 3].value[i % 3]} - contacts[i / 3].value[i % 3]);
    }
    hand += work;
    given += std::max(work, 0.0);
    switches += report.work;
    gliding += report.share < 1 ? 1 : 0;
    contacts = next;
    force = body.force;
  }
  MESSAGE(gliding, " steps gliding; the hand gave ", given, " J and lost ", hand, " J, switches put in ", switches,
          " J");
  CHECK(gliding > 500);
  CHECK(share == 1);
  CHECK(std::abs(switches) > 0.01 * given);
  CHECK(std::abs(hand + switches) <= 1e-5 * given);
}

}  // namespace
}  // namespace greenloop
