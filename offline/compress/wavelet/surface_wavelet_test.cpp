#include "offline/compress/wavelet/surface_wavelet.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <utility>

#include "formats/verify.hpp"
#include "offline/compress/testing/dense_compliance.hpp"
#include "offline/compress/wavelet/butterfly_stencil.hpp"
#include "offline/compress/wavelet/equilibrated_prediction.hpp"
#include "offline/compress/wavelet/node_order.hpp"

namespace greenloop::offline {
namespace {

using layout::Wavelet;

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

// from arbitrary rows with arbitrary weights of N N numbers
template <unsigned N>
std::vector<PredictionsData> arbitrary_predictions(const SurfaceWavelet& linear) {
  std::mt19937_64 random(20261129);
  std::vector<PredictionsData> predictions(linear.finest() + 1);
  for (std::size_t level = 1; level <= linear.finest(); ++level) {
    predictions[level].terms = 5;
    for (std::size_t k = 0; k < 5 * linear.odds(level).size(); ++k) {
      predictions[level].index.push_back(static_cast<std::uint32_t>(random() % linear.row_end(level - 1)));
      for (unsigned e = 0; e < N * N; ++e) {
        predictions[level].weight.push_back(static_cast<std::int16_t>(static_cast<int>(random() % 1601) - 800));
      }
    }
  }
  return predictions;
}

template <unsigned N = 3>
SurfaceWavelet wavelet_of(const Domain& domain, Wavelet kind = Wavelet::lifted_linear) {
  if (kind != Wavelet::equilibrated) return {domain.mesh, domain.flags, domain.area, kind};
  return {domain.mesh, domain.flags, domain.area, arbitrary_predictions<N>(wavelet_of(domain, Wavelet::linear)), N};
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

bool inside(const SurfaceWavelet::Odd& odd) {
  return odd.parent[0] != SurfaceWavelet::no_row && odd.parent[1] != SurfaceWavelet::no_row;
}

// all levels, fine to coarse
std::vector<double> split_all(const SurfaceWavelet& wavelet, std::vector<double> x) {
  for (std::size_t level = wavelet.finest(); level > 0; --level) wavelet.split(level, width, x.data());
  return x;
}

double largest_detail(const SurfaceWavelet& wavelet, const std::vector<double>& x, bool inside_only) {
  double largest = 0;
  for (std::size_t level = 1; level <= wavelet.finest(); ++level) {
    for (const auto& odd : wavelet.odds(level)) {
      if (inside_only && !inside(odd)) continue;
      for (std::size_t k = 0; k < width; ++k) largest = std::max(largest, std::abs(x[width * odd.row + k]));
    }
  }
  return largest;
}

TEST_CASE_TEMPLATE("merge undoes split on every level", T, test::Scalars, test::Vectors) {
  constexpr unsigned N = T::value;
  for (const Wavelet kind : layout::wavelets) {
    for (const double z : {-10.0, -0.3}) {
      CAPTURE(kind);
      CAPTURE(z);
      const auto wavelet = wavelet_of<N>(free_above(test::blob(3), z), kind);
      for (std::size_t level = 1; level <= wavelet.finest(); ++level) {
        const auto x = noise(N * wavelet.row_end(level));
        auto y = x;
        wavelet.split(level, N, y.data());
        CHECK(largest_difference(x, y) > 0.1);
        wavelet.merge(level, N, y.data());
        CHECK(largest_difference(x, y) < 1e-12);
      }
    }
  }
}

TEST_CASE_TEMPLATE("split is the matrix of the definition, and split_forces its inverse transpose", T, test::Scalars,
                   test::Vectors) {
  constexpr unsigned N = T::value;
  for (const Wavelet kind : layout::wavelets) {
    CAPTURE(kind);
    const auto wavelet = wavelet_of<N>(free_above(test::blob(2), -0.3), kind);
    for (std::size_t level = 1; level <= wavelet.finest(); ++level) {
      const std::size_t count = N * wavelet.row_end(level);
      const test::Sparse step = test::forward_step<N>(wavelet, level);
      const auto x = noise(count), f = noise(2 * count);
      const Eigen::VectorXd values = Eigen::VectorXd::Map(x.data(), step.cols());
      auto y = x;
      wavelet.split(level, N, y.data());
      CHECK((step * values - Eigen::VectorXd::Map(y.data(), step.rows())).norm() < 1e-12);

      std::vector<double> g(f.begin() + static_cast<std::ptrdiff_t>(count), f.end());
      const Eigen::VectorXd forces = Eigen::VectorXd::Map(g.data(), step.cols());
      wavelet.split_forces(level, N, g.data());
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
  const auto wavelet = wavelet_of(domain), unlifted = wavelet_of(domain, Wavelet::linear);
  CHECK(wavelet.kind() == Wavelet::lifted_linear);
  CHECK(unlifted.kind() == Wavelet::linear);
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
          CHECK(odd.parent[side] == SurfaceWavelet::no_row);
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
  Wavelet kind{};
  SUBCASE("linear") { kind = Wavelet::lifted_linear; }
  SUBCASE("butterfly") { kind = Wavelet::lifted_butterfly; }
  const auto domain = free_above(test::blob(3), -0.3);
  const auto wavelet = wavelet_of(domain, kind);
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
  for (const Wavelet kind : layout::wavelets) {
    if (kind == Wavelet::equilibrated) continue;  // its weights are arbitrary here
    const auto wavelet = wavelet_of(free_above(test::blob(3), -10.0), kind);
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
  for (const Wavelet kind : layout::wavelets) {
    if (kind == Wavelet::equilibrated) continue;  // its weights are arbitrary here
    const auto wavelet = wavelet_of(domain, kind);
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
  for (const Wavelet kind : layout::wavelets) {
    const auto wavelet = wavelet_of(domain, kind);
    const double total = std::accumulate(domain.area.begin(), domain.area.end(), 0.0);
    for (std::size_t level = 0; level <= wavelet.finest(); ++level) {
      const auto& integrals = wavelet.integrals(level);
      CHECK(integrals.size() == wavelet.row_end(level));
      CHECK(std::accumulate(integrals.begin(), integrals.end(), 0.0) == doctest::Approx(total).epsilon(1e-12));
    }
  }
}

// the rows of a level in the middle of a flat square, away from its border and its few irregular nodes
std::vector<double> details_of(const Domain& domain, const SurfaceWavelet& wavelet, std::size_t level,
                               double (*value)(double, double)) {
  std::vector<double> x;
  for (std::size_t row = 0; row < wavelet.row_end(level); ++row) {
    const auto& p = domain.mesh.positions[wavelet.nodes()[row]];
    x.push_back(value(p.x(), p.y()));
  }
  for (const auto& odd : wavelet.odds(level)) {
    for (const auto& [row, weight] : odd.prediction()) x[odd.row] -= weight * x[row];
  }
  std::vector<double> details;
  for (const auto& odd : wavelet.odds(level)) {
    const auto& p = domain.mesh.positions[wavelet.nodes()[odd.row]];
    if (std::max(std::abs(p.x() - 0.5), std::abs(p.y() - 0.5)) < 0.3) details.push_back(std::abs(x[odd.row]));
  }
  return details;
}

TEST_CASE("Butterfly prediction is exact for cubics on a regular grid, Linear for linear functions only") {
  const auto domain = free_above(test::square(4), -1.0);
  const auto linear = wavelet_of(domain, Wavelet::linear), butterfly = wavelet_of(domain, Wavelet::butterfly);
  const auto largest = [&](const SurfaceWavelet& wavelet, double (*value)(double, double)) {
    const auto details = details_of(domain, wavelet, 4, value);
    REQUIRE(details.size() > 50);
    return *std::max_element(details.begin(), details.end());
  };
  const auto quadratic = [](double x, double y) { return 2 * x * x - x * y + 3 * y * y; };
  const auto cubic = [](double x, double y) { return x * x * x - 2 * x * y * y + y; };
  const auto quartic = [](double x, double y) { return x * x * x * x - y * y * x * x; };
  CHECK(largest(linear, quadratic) > 1e-3);
  CHECK(largest(butterfly, quadratic) < 1e-14);
  CHECK(largest(linear, cubic) > 1e-3);
  CHECK(largest(butterfly, cubic) < 1e-14);
  CHECK(largest(butterfly, quartic) > 1e-6);
  CHECK(largest(butterfly, quartic) < 0.1 * largest(linear, quartic));
}

TEST_CASE("a Butterfly stencil is the two triangles at the edge and those across their sides") {
  const auto domain = free_above(test::square(4), -1.0);
  const auto wavelet = wavelet_of(domain, Wavelet::butterfly);
  const auto& mesh = domain.mesh;
  const double h = 0.125;  // of level 3
  std::size_t whole = 0, none = 0;
  for (std::size_t i = 0; i < wavelet.odds(4).size(); ++i) {
    const auto& stencil = wavelet.stencils(4)[i];
    const auto& middle = mesh.positions[wavelet.nodes()[wavelet.odds(4)[i].row]];
    if (!has_stencil(stencil)) {
      // on the border, or beside it
      CHECK(std::max(std::abs(middle.x() - 0.5), std::abs(middle.y() - 0.5)) > 0.5 - h);
      CHECK(wavelet.odds(4)[i].terms == 2);
      ++none;
      continue;
    }
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const std::uint32_t node : stencil.outer) mean += mesh.positions[node] / 4;
    CHECK((mean - middle).norm() < 1e-14);
    const auto &a = mesh.positions[stencil.wing[0]], &b = mesh.positions[stencil.wing[1]];
    CHECK((0.5 * (a + b) - middle).norm() < 1e-14);
    CHECK((a - b).norm() >= h);
    CHECK(wavelet.odds(4)[i].terms == 8);
    ++whole;
  }
  CHECK(whole > 100);
  CHECK(none > 50);
}

TEST_CASE("stencils that meet free nodes outside the domain predict linearly, those that meet held ones do not") {
  const auto mesh = test::blob(3);
  const std::size_t finest = 3;
  Domain domain = free_above(mesh, -0.3);
  const auto held = wavelet_of(domain, Wavelet::butterfly);
  for (auto& flag : domain.flags) flag &= (flag & layout::node_fixed) != 0 ? 0U : ~0U;  // now free, and not needed
  for (std::size_t node = 0; node < domain.flags.size(); ++node) {
    // close the domain: a parent that nobody needs is held
    if ((domain.flags[node] & layout::node_domain) == 0 || node < mesh.vertex_end[0]) continue;
    for (const int parent : mesh.parents[node]) {
      auto& flag = domain.flags[static_cast<std::size_t>(parent)];
      if (flag == 0) flag = layout::node_fixed;
    }
  }
  const auto open = wavelet_of(domain, Wavelet::butterfly);
  std::size_t lost = 0;
  for (std::size_t level = 1; level <= finest; ++level) {
    for (std::size_t i = 0; i < held.odds(level).size(); ++i) {
      const auto& stencil = held.stencils(level)[i];
      REQUIRE(has_stencil(stencil));  // the surface is closed
      std::size_t inside = 0;
      bool unknown = false;
      const auto count = [&](std::uint32_t node) {
        inside += (domain.flags[node] & layout::node_domain) != 0 ? 1 : 0;
        unknown = unknown || domain.flags[node] == 0;
      };
      for (const std::uint32_t node : stencil.wing) count(node);
      for (const std::uint32_t node : stencil.outer) count(node);
      for (const int parent : mesh.parents[held.nodes()[held.odds(level)[i].row]]) {
        count(static_cast<std::uint32_t>(parent));
      }
      CHECK(held.odds(level)[i].terms == inside);
      CHECK(has_stencil(open.stencils(level)[i]) == !unknown);
      CHECK((!unknown || open.odds(level)[i].terms <= 2));
      lost += unknown ? 1 : 0;
    }
  }
  CHECK(lost > 5);
}

TEST_CASE("lifting weights lie between 0 and 1, however uneven the triangles") {
  Domain domain = free_above(test::blob(3), -10.0);
  const auto even = wavelet_of(domain, Wavelet::lifted_butterfly);
  for (std::size_t node = 0; node < domain.area.size(); ++node) domain.area[node] *= node % 7 == 0 ? 1000 : 1;
  const auto uneven = wavelet_of(domain, Wavelet::lifted_butterfly);
  std::size_t dropped = 0, negative = 0;
  for (std::size_t level = 1; level <= uneven.finest(); ++level) {
    for (std::size_t i = 0; i < uneven.odds(level).size(); ++i) {
      const auto& odd = uneven.odds(level)[i];
      for (int side = 0; side < 2; ++side) {
        CHECK(even.odds(level)[i].lift[side] > 0);
        CHECK(odd.lift[side] >= 0);
        CHECK(odd.lift[side] < 1);
        dropped += odd.lift[side] == 0 ? 1 : 0;
        negative += uneven.integrals(level - 1)[odd.parent[side]] <= 0 ? 1 : 0;
      }
    }
  }
  CHECK(dropped > 0);
  CHECK(negative > 0);
}

TEST_CASE_TEMPLATE("the transform read back from a model is the mesh's, whole and cut off", T, test::Scalars,
                   test::Vectors) {
  constexpr unsigned N = T::value;
  const auto body = test::make_body<N>(2);
  for (const Wavelet kind : layout::wavelets) {
    CAPTURE(kind);
    const SurfaceWavelet expected =
        make_wavelet<N>(body.mesh, body.flags, body.area, kind, test::columns_of<N>(body.compliance));
    const test::File file(test::model_of<N>(body, kind, {.threshold = 0.1, .quantum = 0.05}));
    for (std::uint32_t q = 0; q <= 2; ++q) {
      const AlignedBytes part(truncate_to_level({file.bytes.data(), file.bytes.data() + file.bytes.size()}, q));
      ModelView view;
      REQUIRE(verify(part.span(), view).ok());
      const SurfaceWavelet found(view);
      CHECK(found.kind() == kind);
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
          CHECK(std::equal(a.prediction().begin(), a.prediction().end(), b.prediction().begin(), b.prediction().end(),
                           [](const auto& x, const auto& y) { return x.row == y.row && x.weight == y.weight; }));
          const auto blocks = found.block_prediction(a), expected_blocks = expected.block_prediction(b);
          CHECK(blocks.empty() == (N == 1 || kind != Wavelet::equilibrated));
          CHECK(std::equal(blocks.begin(), blocks.end(), expected_blocks.begin(), expected_blocks.end(),
                           [](const auto& x, const auto& y) { return x.row == y.row && x.weight == y.weight; }));
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
