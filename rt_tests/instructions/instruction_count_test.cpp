// The same step takes the same number of instructions every time, whatever the numbers in it: zero, denormal, infinite
// or NaN.
#include <doctest/doctest.h>

#include <algorithm>
#include <cfloat>
#include <limits>
#include <vector>

#include "rt_tests/stress/heaviest_step.hpp"
#include "runtime/cholesky.hpp"
#include "runtime/domain.hpp"
#include "runtime/field.hpp"
#include "runtime/testing/placed_body.hpp"
#include "runtime/testing/test_body.hpp"
#include "sim_hw/guard/instruction_counter.hpp"

namespace greenloop {
namespace {

template <class Work>
std::uint64_t count(Work work) {
  instruction_counter::start();
  work();
  return instruction_counter::stop();
}

// what `kernel` takes with each of these numbers in its input
template <class Kernel>
std::vector<std::uint64_t> counts(Kernel kernel) {
  constexpr float values[] = {1,
                              0,
                              -0.0F,
                              FLT_TRUE_MIN,
                              FLT_MIN,
                              0x1p-80F,
                              FLT_MAX,
                              std::numeric_limits<float>::infinity(),
                              std::numeric_limits<float>::quiet_NaN()};
  kernel(1.0F);  // every library function has been called before
  std::vector<std::uint64_t> result;
  for (const float value : values) {
    result.push_back(count([&] { kernel(value); }));
  }
  return result;
}

bool all_equal(const std::vector<std::uint64_t>& counts) {
  return std::all_of(counts.begin(), counts.end(), [&](std::uint64_t c) { return c == counts[0]; });
}

TEST_CASE("instructions are counted exactly, and a branch on data is seen") {
  if (!instruction_counter::install()) {
    MESSAGE("instructions cannot be counted on this processor; nothing is compared");
    return;
  }
  const auto loop = [](std::uint64_t turns) {
    return count([turns] {
      std::uint64_t left = turns;
      while (left > 0) {
        asm volatile("sub $1, %0" : "+r"(left));
      }
    });
  };
  const std::uint64_t per_turn = loop(101) - loop(100);
  CHECK(per_turn > 0);
  CHECK(loop(1100) - loop(100) == 1000 * per_turn);
  volatile float sum = 0;
  const auto branching = counts([&sum](float value) {
    const volatile float seen = value;
    if (seen > 0.5F) {
      sum = sum + seen;
    }
  });
  CHECK_FALSE(all_equal(branching));
}

TEST_CASE("kernels take the same instructions whatever the numbers") {
  if (!instruction_counter::install()) {
    return;
  }
  const TestModel model({.levels = 2});
  const ModelView& view = model.view();
  const PlacedBody placed(view);
  Body& body = *placed.body;
  const std::vector<std::uint32_t> nodes = model.touchable();
  const std::uint32_t place = domain_place(view, nodes[nodes.size() / 2]);
  std::vector<Float4> x(view.node_count);
  const auto field = counts([&](float value) {
    const float force[] = {value, value, value};
    compute_field({view, body.columns, body.parents}, {1, 1, &place, force}, {1, 1}, body.field_touched, x.data());
  });
  CHECK(all_equal(field));
  CHECK(field[0] > 100);

  touch(body.refinement, 1, &place, 1, body.touched);
  const auto transformed = counts([&](float value) {
    body.force[place] = Float4{value, value, value, 0};
    transform_forces(body.refinement, body.touched, body.force);
    clear_forces(body.touched, body.force);
  });
  CHECK(all_equal(transformed));

  constexpr std::uint32_t order = 12;
  std::vector<Float4> factor(order * order / 4, splat(0.25F));
  std::vector<Float4> b(order / 4);
  const auto solve = counts([&](float value) {
    std::fill(b.begin(), b.end(), splat(value));
    cholesky_solve(order, order, factor.data(), b.data());
  });
  CHECK(all_equal(solve));
}

TEST_CASE("whole steps take the same instructions when repeated and whatever the displacements") {
  if (!instruction_counter::install()) {
    return;
  }
  const TestModel model({.levels = 2});
  TestBody body(model, {.max_contacts = 3, .cached_factors = 1});
  std::vector<float> force(9);
  std::vector<Contact> contacts(3);
  const auto nodes = model.touchable();
  const auto step = [&](float value) {
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      contacts[i] = {nodes[2 * i], {value, -value, value}};
    }
    return count([&] { body.body().step(contacts, {any_budget}, {force, body.field()}); });
  };
  step(1e-3F);
  step(1e-3F);  // every library function has been called before, with the factor at hand too
  const std::uint64_t first = step(1e-3F);
  for (const float value : {1e-3F, 0.0F, FLT_TRUE_MIN, 0x1p-100F, 1.0F}) {
    CAPTURE(value);
    CHECK(step(value) == first);
  }
  const Limits limits{.max_contacts = 3, .cached_factors = 1};
  const std::int64_t heaviest = instructions_of_heaviest_step(model.model(), limits);
  CHECK(heaviest > static_cast<std::int64_t>(first));
  CHECK(instructions_of_heaviest_step(model.model(), limits) == heaviest);
}

}  // namespace
}  // namespace greenloop
