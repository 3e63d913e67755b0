// The same step takes the same number of instructions every time, whatever the numbers in it: zero, denormal, infinite
// or NaN.
#include <doctest/doctest.h>

#include <algorithm>
#include <cfloat>
#include <limits>
#include <vector>

#include "rt_tests/harness/elastostatic_driver.hpp"
#include "rt_tests/instructions/counted.hpp"
#include "runtime/algebra/cholesky.hpp"
#include "runtime/compliance/field.hpp"
#include "runtime/testing/placed_body.hpp"
#include "runtime/testing/test_body.hpp"
#include "runtime/wavelet/domain.hpp"

namespace greenloop {
namespace {

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
  const auto nothing = [] {};
  return count_each(std::size(values), nothing, [&](std::size_t i) { kernel(values[i]); });
}

TEST_CASE("instructions are counted exactly, and a branch on data is seen") {
  if (!instruction_counter::install()) {
    MESSAGE("instructions cannot be counted on this processor; nothing is compared");
    return;
  }
  const auto loop = [](std::uint64_t turns) {
    return count_instructions([turns] {
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
  layout::Wavelet kind{};
  SUBCASE("lifted linear") { kind = layout::Wavelet::lifted_linear; }
  SUBCASE("equilibrated") { kind = layout::Wavelet::equilibrated; }
  if (!instruction_counter::install()) {
    return;
  }
  const TestModel model({.levels = 2, .wavelet = kind});
  const ModelView& view = model.view();
  const PlacedBody placed(view);
  Body& body = *placed.body;
  const std::vector<std::uint32_t> nodes = model.touchable();
  const std::uint32_t place = domain_place(view, nodes[nodes.size() / 2]);
  const std::uint32_t column = make_column(1, place);
  std::vector<Float4> x(view.node_count);
  touch(body.refinement, &column, 1, body.touched);
  const auto field = counts([&](float value) {
    const float force[] = {value, value, value};
    compute_field<3>(body.field_model(), {1, &column, force}, body.touched, {1, 1}, body.field_scratch(), x.data());
  });
  CHECK(all_equal(field));
  CHECK(field[0] > 100);

  const auto transformed = counts([&](float value) {
    const float force[] = {value, value, value};
    transform_forces<3>(body.refinement, {1, &column, force}, body.touched, body.force);
    clear_forces<3>(body.touched, body.force);
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

// a matrix by whole columns: `scale` on the diagonal and `off` times it beside it
std::vector<Float4> matrix(std::uint32_t order, float scale, float off) {
  std::vector<Float4> a(std::size_t{order} * order / 4, splat(scale * off));
  for (std::uint32_t i = 0; i < order; ++i) {
    a[(std::size_t{order} + 1) * i / 4][((order + 1) * i) % 4] = scale;
  }
  return a;
}

TEST_CASE("factors take the same instructions whatever the matrix, unless it is not positive definite") {
  if (!instruction_counter::install()) {
    return;
  }
  constexpr std::uint32_t order = 24;
  std::vector<std::uint64_t> fresh, removed, appended;
  const auto count = [&](float scale, float off) {
    std::vector<Float4> a = matrix(order, scale, off);
    const std::vector<Float4> all = a;
    std::vector<Float4> border(3 * order / 4);
    bool good = false;
    const auto whole = [&] { std::copy(all.begin(), all.end(), a.begin()); };
    const auto factored = [&] {
      std::copy(all.begin(), all.end(), a.begin());
      good = cholesky_factor(order, order, a.data());
    };
    const auto shortened = [&] {
      factored();
      cholesky_remove(order, 6, 3, order, a.data(), border.data());
      border.assign(all.end() - 3 * order / 4, all.end());
    };
    fresh.push_back(count_instructions(whole, [&] { good = cholesky_factor(order, order, a.data()); }));
    CHECK(good);
    removed.push_back(
        count_instructions(factored, [&] { cholesky_remove(order, 6, 3, order, a.data(), border.data()); }));
    appended.push_back(
        count_instructions(shortened, [&] { good = cholesky_append(order - 3, 3, order, a.data(), border.data()); }));
    CHECK(good);
  };
  count(1, 0);  // every library function has been called before
  fresh.clear(), removed.clear(), appended.clear();
  for (const float scale : {1.0F, 0x1p-60F, 0x1p60F}) {
    for (const float off : {0.0F, -0.0F, FLT_TRUE_MIN, 0x1p-100F, 0.01F, -0.01F}) {
      CAPTURE(scale);
      CAPTURE(off);
      count(scale, off);
    }
  }
  CHECK(all_equal(fresh));
  CHECK(all_equal(removed));
  CHECK(all_equal(appended));
  for (const float bad :
       {0.0F, -1.0F, std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()}) {
    CAPTURE(bad);
    std::vector<Float4> a = matrix(order, bad, 0);
    bool good = true;
    const std::vector<Float4> all = a;
    CHECK(count_instructions([&] { std::copy(all.begin(), all.end(), a.begin()); },
                             [&] { good = cholesky_factor(order, order, a.data()); }) < fresh[0]);
    CHECK_FALSE(good);
  }
}

TEST_CASE("whole steps take the same instructions when repeated and whatever the displacements") {
  if (!instruction_counter::install()) {
    return;
  }
  const TestModel model({.levels = 2});
  TestBody body(model, {.max_contacts = 3, .cached_factors = 1});
  std::vector<float> force(9);
  std::vector<Constraint> contacts(3);
  const auto nodes = model.touchable();
  const auto step = [&] { body.body().step(contacts, {any_budget}, {as_vec3(force), as_vec4(body.field())}); };
  const auto displace = [&](float value) {
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      contacts[i] = {nodes[2 * i], {value, -value, value}};
    }
  };
  displace(1e-3F);
  step();
  step();  // every library function has been called before, with the factor at hand too
  const std::uint64_t first = count_instructions(step);
  for (const float value : {1e-3F, 0.0F, FLT_TRUE_MIN, 0x1p-100F, 1.0F}) {
    CAPTURE(value);
    displace(value);
    CHECK(count_instructions(step) == first);
  }
}

}  // namespace
}  // namespace greenloop
