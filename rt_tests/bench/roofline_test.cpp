#include "rt_tests/bench/roofline.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <string>

#include "rt_tests/bench/kernel_benchmark.hpp"
#include "runtime/testing/test_body.hpp"

namespace greenloop::bench {
namespace {

TEST_CASE("every kernel has a point, with the bytes and flops that its order takes") {
  layout::Wavelet kind{};
  SUBCASE("lifted linear") { kind = layout::Wavelet::lifted_linear; }
  SUBCASE("equilibrated") { kind = layout::Wavelet::equilibrated; }
  const TestModel model({.levels = 4, .wavelet = kind});
  const Roofline roofline = measure_roofline(model.model(), {1, 4}, 3);
  CHECK(roofline.gflops > 0);
  CHECK(std::all_of(roofline.gb_per_s.begin(), roofline.gb_per_s.end(), [](double speed) { return speed > 0; }));
  const auto point = [&](const std::string& kernel, std::size_t contacts) {
    const auto at = std::find_if(roofline.points.begin(), roofline.points.end(),
                                 [&](auto& p) { return p.kernel == kernel && p.contacts == contacts; });
    REQUIRE(at != roofline.points.end());
    CHECK(at->us >= 0);
    CHECK(at->bound_us > 0);
    CHECK(at->compute_us > 0);
    return *at;
  };
  constexpr double order = 12, triangle = 4 * order * (order + 1) / 2;
  CHECK(point("Cholesky", 4).bytes == 2 * triangle);
  CHECK(point("Cholesky", 4).flops == order * order * order / 3);
  CHECK(point("triangular solution", 4).bytes == 2 * triangle + 16 * order);
  CHECK(point("triangular solution", 4).flops == 2 * order * order);
  CHECK(point("capacitance matrix", 4).bytes > triangle);
  constexpr double elements = 10, of_a_weight = 18;
  CHECK(point("capacitance matrix", 4).flops > 2 * of_a_weight * elements);  // one to a sum, one from it
  const RooflinePoint one = point("field couplings", 1), four = point("field couplings", 4);
  CHECK(one.flops > 0);
  CHECK(four.flops > one.flops);  // they share coefficients
  CHECK(four.bytes > one.bytes);
  CHECK(point("field couplings, cold", 4).bytes == four.bytes);
  CHECK(point("inverse transform", 4).bytes > 32 * model.view().node_count);
}

TEST_CASE("a body is made in the bytes that it requires") {
  const TestModel model({.levels = 4});
  const Elastostatic::Limits limits{.max_contacts = 5, .cached_factors = 2};
  const CreationFigures figures = measure_creation(model.model(), limits);
  CHECK(figures.arena_bytes == Elastostatic::required(model.model(), limits).bytes);
  CHECK(figures.create_ms > 0);
}

}  // namespace
}  // namespace greenloop::bench
