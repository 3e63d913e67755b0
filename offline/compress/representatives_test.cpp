#include "offline/compress/hierarchy.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numeric>

#include "offline/compress/test_body.hpp"

namespace greenloop::offline {
namespace {

struct FreeSurface {
  SemiRegularMesh mesh = test::blob(3);
  std::vector<double> area = test::nodal_area(mesh);
  std::vector<std::size_t> all = [this] {
    std::vector<std::size_t> nodes(mesh.positions.size());
    std::iota(nodes.begin(), nodes.end(), std::size_t{0});
    return nodes;
  }();
};

TEST_CASE("the finest constraint level is the exact columns themselves") {
  const FreeSurface s;
  const auto level = constraint_level(s.mesh, s.area, s.all, 3);
  REQUIRE(level.columns.size() == s.all.size());
  for (std::size_t j = 0; j < s.all.size(); ++j) {
    CHECK(level.columns[j].node == j);
    CHECK(level.columns[j].area == static_cast<float>(s.area[j]));
    REQUIRE(level.share[j].size() == 1);
    CHECK(level.share[j][0].vertex == j);
    CHECK(level.share[j][0].weight == 1.0);
    CHECK(level.representatives[j] == j);
  }
}

TEST_CASE("coarse hats cover the surface and carry a unit force each") {
  const FreeSurface s;
  const double total = std::accumulate(s.area.begin(), s.area.end(), 0.0);
  for (std::uint32_t c = 0; c < 3; ++c) {
    CAPTURE(c);
    const auto level = constraint_level(s.mesh, s.area, s.all, c);
    REQUIRE(level.columns.size() == s.mesh.vertex_end[c]);
    double covered = 0;
    for (const auto& column : level.columns) covered += static_cast<double>(column.area);
    CHECK(covered == doctest::Approx(total).epsilon(1e-6));
    std::vector<double> force(level.columns.size(), 0.0);
    for (std::size_t j = 0; j < level.share.size(); ++j) {
      CHECK(level.share[j].size() <= 3);
      for (const auto& [column, weight] : level.share[j]) force[column] += weight;
    }
    for (const double sum : force) CHECK(sum == doctest::Approx(1.0).epsilon(1e-12));
  }
}

TEST_CASE("a coarse hat is the finer one plus half of its odd neighbours'") {
  const FreeSurface s;
  for (std::uint32_t c = 0; c < 3; ++c) {
    const auto coarse = constraint_level(s.mesh, s.area, s.all, c);
    const auto fine = constraint_level(s.mesh, s.area, s.all, c + 1);
    std::vector<double> area;
    for (std::size_t k = 0; k < coarse.columns.size(); ++k) area.push_back(static_cast<double>(fine.columns[k].area));
    for (std::size_t m = s.mesh.vertex_end[c]; m < s.mesh.vertex_end[c + 1]; ++m) {
      for (const int parent : s.mesh.parents[m]) {
        area[static_cast<std::size_t>(parent)] += 0.5 * static_cast<double>(fine.columns[m].area);
      }
    }
    for (std::size_t k = 0; k < area.size(); ++k) {
      CHECK(static_cast<double>(coarse.columns[k].area) == doctest::Approx(area[k]).epsilon(1e-5));
    }
  }
}

TEST_CASE("columns gathered from a stream are the weighted sums of the exact ones") {
  const auto body = test::make_body(2);
  const auto level = constraint_level(body.mesh, body.area, body.column_nodes, 1);
  const std::size_t count = body.column_nodes.size();
  CoarseColumns gathered(level, count);
  for (std::size_t first = 0; first < count; first += 50) {
    const std::size_t width = std::min<std::size_t>(50, count - first);
    gathered.add(body.compliance.middleCols(static_cast<Eigen::Index>(3 * first), static_cast<Eigen::Index>(3 * width)),
                 first);
  }
  Eigen::MatrixXd weights =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(3 * count), static_cast<Eigen::Index>(3 * level.columns.size()));
  for (std::size_t j = 0; j < count; ++j) {
    for (const auto& [column, weight] : level.share[j]) {
      weights.block<3, 3>(static_cast<Eigen::Index>(3 * j), static_cast<Eigen::Index>(3 * column))
          .diagonal()
          .setConstant(weight);
    }
  }
  const Eigen::MatrixXd expected = body.compliance * weights;
  const Eigen::MatrixXd actual = gathered.source()(0, level.columns.size());
  CHECK((actual - expected).norm() < 1e-6 * expected.norm());
}

TEST_CASE("a node is represented by its largest hat, or by the nearest column where no hat has one") {
  const FreeSurface s;
  SUBCASE("inside") {
    const auto level = constraint_level(s.mesh, s.area, s.all, 2);
    for (std::size_t node = 0; node < s.all.size(); ++node) {
      if (node < s.mesh.vertex_end[2]) {
        CHECK(level.representatives[node] == node);
      } else {
        CHECK(level.representatives[node] == static_cast<std::uint32_t>(s.mesh.parents[node][0]));
      }
    }
  }
  SUBCASE("only one base vertex can be touched") {
    std::vector<std::size_t> nodes = {5};
    for (std::size_t node = s.mesh.vertex_end[0]; node < s.all.size(); ++node) nodes.push_back(node);
    const auto level = constraint_level(s.mesh, s.area, nodes, 0);
    REQUIRE(level.columns.size() == 1);
    CHECK(level.columns[0].node == 5);
    for (const std::size_t node : nodes) CHECK(level.representatives[node] == 0);
    CHECK(level.representatives[0] == layout::none);
  }
  SUBCASE("the nearest of several") {
    std::vector<std::size_t> nodes = {2, 7};
    const std::size_t far = s.all.size() - 1;
    nodes.push_back(far);
    const auto level = constraint_level(s.mesh, s.area, nodes, 0);
    bool reached = false;
    for (const auto& share : level.share[2]) reached = reached || share.weight > 0;
    if (!reached) {
      const auto& p = s.mesh.positions;
      const bool first = (p[far] - p[2]).norm() < (p[far] - p[7]).norm();
      CHECK(level.representatives[far] == (first ? 0 : 1));
    }
    CHECK_FALSE(reached);
  }
}

TEST_CASE("column nodes out of order or out of range are refused") {
  const FreeSurface s;
  CHECK_THROWS_AS((void)constraint_level(s.mesh, s.area, {4, 3}, 0), std::invalid_argument);
  CHECK_THROWS_AS((void)constraint_level(s.mesh, s.area, {3, 3}, 0), std::invalid_argument);
  CHECK_THROWS_AS((void)constraint_level(s.mesh, s.area, {s.all.size()}, 0), std::invalid_argument);
}

}  // namespace
}  // namespace greenloop::offline
