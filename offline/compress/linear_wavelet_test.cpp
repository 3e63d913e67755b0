#include "offline/compress/linear_wavelet.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <utility>

#include "formats/verify.hpp"
#include "offline/compress/dense_reference.hpp"
#include "offline/compress/node_order.hpp"

namespace greenloop::offline {
namespace {

constexpr std::size_t width = 3;

// all nodes above z are free
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

LinearWavelet wavelet_of(const Domain& domain, bool lifted = true) {
  return {domain.mesh, domain.flags, domain.area, lifted};
}

std::vector<double> noise(std::size_t count) {
  const std::uint64_t seed = 20240611;
  std::mt19937_64 random(seed);
  std::vector<double> x(count);
  for (auto& value : x) value = static_cast<double>(random() >> 11) * 0x1p-53 - 0.5;
  return x;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double worst = 0;
  for (std::size_t i = 0; i < a.size(); ++i) worst = std::max(worst, std::abs(a[i] - b[i]));
  return worst;
}

bool inside(const LinearWavelet::Odd& odd) {
  return odd.parent[0] != LinearWavelet::no_row && odd.parent[1] != LinearWavelet::no_row;
}

// all levels, fine to coarse
std::vector<double> split_all(const LinearWavelet& wavelet, std::vector<double> x) {
  for (std::size_t level = wavelet.finest(); level > 0; --level) wavelet.split(level, width, x.data());
  return x;
}

double largest_detail(const LinearWavelet& wavelet, const std::vector<double>& x, bool inside_only) {
  double largest = 0;
  for (std::size_t level = 1; level <= wavelet.finest(); ++level) {
    for (const auto& odd : wavelet.odds(level)) {
      if (inside_only && !inside(odd)) continue;
      for (std::size_t k = 0; k < width; ++k) largest = std::max(largest, std::abs(x[width * odd.row + k]));
    }
  }
  return largest;
}

TEST_CASE("merge undoes split on every level") {
  for (const bool lifted : {true, false}) {
    for (const double z : {-10.0, -0.3}) {
      CAPTURE(lifted);
      CAPTURE(z);
      const auto wavelet = wavelet_of(free_above(test::blob(3), z), lifted);
      for (std::size_t level = 1; level <= wavelet.finest(); ++level) {
        const auto x = noise(width * wavelet.row_end(level));
        auto y = x;
        wavelet.split(level, width, y.data());
        CHECK(largest_difference(x, y) > 0.1);
        wavelet.merge(level, width, y.data());
        CHECK(largest_difference(x, y) < 1e-12);
      }
    }
  }
}

TEST_CASE("split is the matrix of the definition, and split_forces its inverse transpose") {
  for (const bool lifted : {true, false}) {
    CAPTURE(lifted);
    const auto wavelet = wavelet_of(free_above(test::blob(2), -0.3), lifted);
    for (std::size_t level = 1; level <= wavelet.finest(); ++level) {
      const std::size_t count = width * wavelet.row_end(level);
      const test::Sparse step = test::forward_step(wavelet, level);
      const auto x = noise(count), f = noise(2 * count);
      const Eigen::VectorXd values = Eigen::VectorXd::Map(x.data(), step.cols());
      auto y = x;
      wavelet.split(level, width, y.data());
      CHECK((step * values - Eigen::VectorXd::Map(y.data(), step.rows())).norm() < 1e-12);

      std::vector<double> g(f.begin() + static_cast<std::ptrdiff_t>(count), f.end());
      const Eigen::VectorXd forces = Eigen::VectorXd::Map(g.data(), step.cols());
      wavelet.split_forces(level, width, g.data());
      const Eigen::VectorXd found = Eigen::VectorXd::Map(g.data(), step.cols());
      CHECK((step.transpose() * found - forces).norm() < 1e-12);
      CHECK((found - forces).norm() > 0.1);
      // work is the same in both coordinates
      CHECK(found.dot(step * values) == doctest::Approx(forces.dot(values)).epsilon(1e-12));
    }
  }
}

TEST_CASE("odd rows have the mesh's parents, and lift by the ratio of integrals") {
  const auto domain = free_above(test::blob(3), -0.3);
  const auto wavelet = wavelet_of(domain), unlifted = wavelet_of(domain, false);
  CHECK(wavelet.lifted());
  CHECK_FALSE(unlifted.lifted());
  std::size_t cut = 0;
  for (std::size_t level = 1; level <= wavelet.finest(); ++level) {
    REQUIRE(wavelet.odds(level).size() == wavelet.row_end(level) - wavelet.row_end(level - 1));
    for (std::size_t i = 0; i < wavelet.odds(level).size(); ++i) {
      const auto& odd = wavelet.odds(level)[i];
      CHECK(odd.row == wavelet.row_end(level - 1) + i);
      for (int side = 0; side < 2; ++side) {
        CHECK(unlifted.odds(level)[i].lift[side] == 0.0F);
        const auto parent =
            static_cast<std::size_t>(domain.mesh.parents[wavelet.nodes()[odd.row]][static_cast<std::size_t>(side)]);
        if ((domain.flags[parent] & layout::node_domain) == 0) {
          CHECK(odd.parent[side] == LinearWavelet::no_row);
          CHECK(odd.lift[side] == 0.0F);
          ++cut;
        } else {
          REQUIRE(wavelet.nodes()[odd.parent[side]] == parent);
          const double ratio = wavelet.integrals(level)[odd.row] / (2 * wavelet.integrals(level - 1)[odd.parent[side]]);
          CHECK(static_cast<double>(odd.lift[side]) == doctest::Approx(ratio).epsilon(1e-6));
        }
      }
    }
  }
  CHECK(cut > 10);
}

TEST_CASE("lifted wavelets have zero mean where both parents are in the domain, half a mean where one is") {
  const auto domain = free_above(test::blob(3), -0.3);
  const auto wavelet = wavelet_of(domain);
  std::size_t whole = 0, border = 0;
  for (std::size_t level = 1; level <= wavelet.finest(); ++level) {
    for (const auto& odd : wavelet.odds(level)) {
      std::vector<double> x(wavelet.rows(), 0.0);
      x[odd.row] = 1;
      for (std::size_t l = level; l <= wavelet.finest(); ++l) wavelet.merge(l, 1, x.data());
      double mean = 0, size = 0;
      for (std::size_t i = 0; i < wavelet.rows(); ++i) {
        mean += domain.area[wavelet.nodes()[i]] * x[i];
        size += domain.area[wavelet.nodes()[i]] * std::abs(x[i]);
      }
      if (inside(odd)) {
        CHECK(std::abs(mean) < 1e-6 * size);
        ++whole;
      } else if (odd.parent[0] != odd.parent[1]) {
        CHECK(mean > 0.01 * size);
        ++border;
      }
    }
  }
  CHECK(whole > 300);
  CHECK(border > 10);
}

TEST_CASE("a constant on a free surface has no details, and none inside a partly fixed one") {
  for (const bool lifted : {true, false}) {
    const auto wavelet = wavelet_of(free_above(test::blob(3), -10.0), lifted);
    CHECK(wavelet.rows() == 642);
    const auto x = split_all(wavelet, std::vector<double>(width * wavelet.rows(), 2.5));
    CHECK(largest_detail(wavelet, x, false) < 1e-14);
    for (std::size_t i = 0; i < width * wavelet.row_end(0); ++i) {
      CHECK(x[i] == doctest::Approx(2.5).epsilon(1e-14));
    }
  }
  const auto cut = wavelet_of(free_above(test::blob(1), -0.3));
  const auto y = split_all(cut, std::vector<double>(width * cut.rows(), 2.5));
  CHECK(largest_detail(cut, y, true) < 1e-14);
  CHECK(largest_detail(cut, y, false) > 1.0);  // the step to the fixed nodes does show
}

TEST_CASE("linear data on a flat mesh has no details, nor on its border") {
  const auto domain = free_above(test::square(4), -1.0);
  for (const bool lifted : {true, false}) {
    const auto wavelet = wavelet_of(domain, lifted);
    std::vector<double> x(width * wavelet.rows());
    for (std::size_t i = 0; i < wavelet.rows(); ++i) {
      const auto& p = domain.mesh.positions[wavelet.nodes()[i]];
      for (std::size_t k = 0; k < width; ++k) x[width * i + k] = 1.0 + static_cast<double>(k) * p.x() - 3.0 * p.y();
    }
    CHECK(largest_detail(wavelet, split_all(wavelet, x), false) < 1e-14);
  }
}

TEST_CASE("the scaling functions of every level cover the free surface") {
  const auto domain = free_above(test::blob(3), -10.0);
  const auto wavelet = wavelet_of(domain);
  const double total = std::accumulate(domain.area.begin(), domain.area.end(), 0.0);
  for (std::size_t level = 0; level <= wavelet.finest(); ++level) {
    const auto& integrals = wavelet.integrals(level);
    CHECK(integrals.size() == wavelet.row_end(level));
    CHECK(std::accumulate(integrals.begin(), integrals.end(), 0.0) == doctest::Approx(total).epsilon(1e-12));
  }
}

TEST_CASE("the transform read back from a model is the mesh's, whole and cut off") {
  const auto body = test::make_body(2);
  for (const bool lifted : {true, false}) {
    CAPTURE(lifted);
    const LinearWavelet expected(body.mesh, body.flags, body.area, lifted);
    const test::File file(test::model_of(body, lifted, {.threshold = 0.1, .quantum = 0.05}));
    for (std::uint32_t q = 0; q <= 2; ++q) {
      const AlignedBytes part(truncate_to_level({file.bytes.data(), file.bytes.data() + file.bytes.size()}, q));
      ModelView view;
      REQUIRE(verify(part.span(), view).ok());
      const LinearWavelet found(view);
      CHECK(found.lifted() == lifted);
      REQUIRE(found.finest() == q);
      CHECK(found.rows() == expected.row_end(q));
      CHECK(std::equal(found.nodes().begin(), found.nodes().end(), expected.nodes().begin()));
      for (std::size_t level = 1; level <= q; ++level) {
        REQUIRE(found.row_end(level) == expected.row_end(level));
        for (std::size_t i = 0; i < found.odds(level).size(); ++i) {
          const auto &a = found.odds(level)[i], &b = expected.odds(level)[i];
          CHECK(a.row == b.row);
          CHECK(std::equal(a.parent, a.parent + 2, b.parent));
          CHECK(std::equal(a.lift, a.lift + 2, b.lift));
        }
      }
    }
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
