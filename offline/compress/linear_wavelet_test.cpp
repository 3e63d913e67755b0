#include "offline/compress/lifted_linear.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "formats/layout.hpp"
#include "offline/compress/node_order.hpp"
#include "offline/compress/test_body.hpp"

namespace greenloop::offline {
namespace {

constexpr std::size_t width = LiftedLinear::components;

/// All nodes free but a cap, closed.
struct Domain {
  SemiRegularMesh mesh;
  std::vector<std::uint32_t> flags;
  std::vector<double> area;
};

Domain free_above(SemiRegularMesh mesh, double z) {
  Domain domain{std::move(mesh), {}, {}};
  for (const auto& p : domain.mesh.positions) {
    domain.flags.push_back(p.z() >= z ? layout::node_read : layout::node_fixed);
  }
  domain.flags = mark_domain(domain.mesh, domain.flags);
  domain.area = test::nodal_area(domain.mesh);
  return domain;
}

LiftedLinear wavelet_of(const Domain& domain) { return {domain.mesh, domain.flags, domain.area}; }

template <typename T>
double largest_detail(const LiftedLinear& wavelet, const std::vector<T>& x, bool inside_only) {
  double largest = 0;
  for (const auto& step : wavelet.steps()) {
    const bool inside = step.parent[0] < wavelet.rows() && step.parent[1] < wavelet.rows();
    if (inside_only && !inside) continue;
    for (std::size_t k = 0; k < width; ++k) {
      largest = std::max(largest, std::abs(static_cast<double>(x[width * step.row + k])));
    }
  }
  return largest;
}

TEST_CASE_TEMPLATE("the inverse undoes the forward transform", T, float, double) {
  const auto domain = free_above(test::blob(3), -0.3);
  const auto wavelet = wavelet_of(domain);
  const std::uint64_t seed = 20240611;
  CAPTURE(seed);
  std::mt19937_64 random(seed);
  std::vector<double> x((wavelet.rows() + 1) * width, 0.0);
  for (std::size_t i = 0; i < wavelet.rows() * width; ++i) x[i] = static_cast<double>(random() >> 11) * 0x1p-53 - 0.5;
  auto y = x;
  wavelet.forward(y.data());
  CHECK(largest_detail(wavelet, y, false) > 0.1);
  std::vector<T> z(y.begin(), y.end());
  wavelet.inverse(z.data());
  double worst = 0;
  for (std::size_t i = 0; i < x.size(); ++i) worst = std::max(worst, std::abs(static_cast<double>(z[i]) - x[i]));
  CHECK(worst < (sizeof(T) == 8 ? 1e-14 : 2e-6));
  for (std::size_t k = 0; k < width; ++k) CHECK(z[wavelet.rows() * width + k] == 0);
}

TEST_CASE("wavelets have zero mean where both parents are in the domain, half a mean where one is") {
  const auto domain = free_above(test::blob(3), -0.3);
  const auto wavelet = wavelet_of(domain);
  std::size_t inside = 0, border = 0;
  for (const auto& step : wavelet.steps()) {
    std::vector<double> x((wavelet.rows() + 1) * width, 0.0);
    x[width * step.row] = 1.0;
    wavelet.inverse(x.data());
    double mean = 0, size = 0;
    for (std::size_t i = 0; i < wavelet.rows(); ++i) {
      mean += domain.area[wavelet.nodes()[i]] * x[width * i];
      size += domain.area[wavelet.nodes()[i]] * std::abs(x[width * i]);
    }
    const bool a = step.parent[0] < wavelet.rows(), b = step.parent[1] < wavelet.rows();
    if (a && b) {
      CHECK(std::abs(mean) < 1e-6 * size);
      ++inside;
    } else if (a || b) {
      CHECK(mean > 0.01 * size);
      ++border;
    }
  }
  CHECK(inside > 300);
  CHECK(border > 10);
}

TEST_CASE("a constant on a free surface has no details, and none inside a partly fixed one") {
  const auto all = free_above(test::blob(3), -10.0);
  const auto wavelet = wavelet_of(all);
  CHECK(wavelet.rows() == all.mesh.positions.size());
  std::vector<double> x((wavelet.rows() + 1) * width, 0.0);
  std::fill_n(x.begin(), wavelet.rows() * width, 2.5);
  wavelet.forward(x.data());
  CHECK(largest_detail(wavelet, x, false) < 1e-14);
  for (std::size_t i = 0; i < wavelet.row_begin(1) * width; ++i) CHECK(x[i] == doctest::Approx(2.5).epsilon(1e-14));

  const auto part = free_above(test::blob(1), -0.3);
  const auto cut = wavelet_of(part);
  std::vector<double> y((cut.rows() + 1) * width, 0.0);
  std::fill_n(y.begin(), cut.rows() * width, 2.5);
  cut.forward(y.data());
  CHECK(largest_detail(cut, y, true) < 1e-14);
  CHECK(largest_detail(cut, y, false) > 1.0);  // the step to the fixed nodes does show
}

TEST_CASE("linear data on a flat mesh has no details") {
  const auto domain = free_above(test::square(4), -1.0);
  const auto wavelet = wavelet_of(domain);
  std::vector<double> x((wavelet.rows() + 1) * width, 0.0);
  for (std::size_t i = 0; i < wavelet.rows(); ++i) {
    const auto& p = domain.mesh.positions[wavelet.nodes()[i]];
    for (std::size_t k = 0; k < width; ++k) x[width * i + k] = 1.0 + static_cast<double>(k) * p.x() - 3.0 * p.y();
  }
  wavelet.forward(x.data());
  CHECK(largest_detail(wavelet, x, false) < 1e-14);
}

TEST_CASE("the scaling functions of every level cover the free surface") {
  const auto domain = free_above(test::blob(3), -10.0);
  const auto wavelet = wavelet_of(domain);
  const double total = std::accumulate(domain.area.begin(), domain.area.end(), 0.0);
  for (std::size_t level = 0; level < wavelet.levels(); ++level) {
    const auto& integrals = wavelet.integrals(level);
    CHECK(integrals.size() == wavelet.row_begin(level + 1));
    CHECK(std::accumulate(integrals.begin(), integrals.end(), 0.0) == doctest::Approx(total).epsilon(1e-12));
  }
}

TEST_CASE("domains that cannot be transformed are refused") {
  auto domain = free_above(test::blob(2), -10.0);
  SUBCASE("a free parent is missing") { domain.flags[static_cast<std::size_t>(domain.mesh.parents.back()[0])] = 0; }
  SUBCASE("an area is zero") { domain.area.back() = 0.0; }
  SUBCASE("flags of another mesh") { domain.flags.pop_back(); }
  CHECK_THROWS_AS((void)wavelet_of(domain), std::invalid_argument);
}

}  // namespace
}  // namespace greenloop::offline
