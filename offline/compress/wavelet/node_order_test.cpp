#include "offline/compress/wavelet/node_order.hpp"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <set>

#include "formats/layout.hpp"
#include "offline/compress/testing/test_body.hpp"

namespace greenloop::offline {
namespace {

constexpr std::uint32_t domain = layout::node_domain;

/// The sum of a triangle's corners, which names it whatever its vertices are called.
std::set<std::array<double, 3>> triangle_names(const SemiRegularMesh& mesh) {
  std::set<std::array<double, 3>> names;
  for (const auto& triangle : triangles_of_level(mesh, mesh.finest_level())) {
    const auto& a = mesh.positions[static_cast<std::size_t>(triangle[0])];
    const auto& b = mesh.positions[static_cast<std::size_t>(triangle[1])];
    const auto& c = mesh.positions[static_cast<std::size_t>(triangle[2])];
    CHECK((b - a).cross(c - a).dot(a) > 0);  // counter-clockwise from outside
    const Eigen::Vector3d sum = a + b + c;
    names.insert({sum.x(), sum.y(), sum.z()});
  }
  return names;
}

TEST_CASE("order_nodes keeps levels, puts the domain first and keeps the surface") {
  const auto mesh = test::icosphere(3);
  std::vector<std::uint32_t> flags;
  for (const auto& p : mesh.positions) flags.push_back(p.z() > -0.5 ? layout::node_read : layout::node_fixed);
  flags = mark_domain(mesh, flags);
  const auto ordered = order_nodes(mesh, flags);

  CHECK(ordered.mesh.vertex_end == mesh.vertex_end);
  auto all = ordered.source;
  std::sort(all.begin(), all.end());
  for (std::size_t i = 0; i < all.size(); ++i) REQUIRE(all[i] == i);
  const auto sorted = ordered.reorder(flags);
  std::size_t begin = 0;
  for (const std::size_t end : mesh.vertex_end) {
    for (std::size_t node = begin; node < end; ++node) {
      CHECK(ordered.source[node] >= begin);
      CHECK(ordered.source[node] < end);
      if (node > begin) CHECK((sorted[node] & domain) <= (sorted[node - 1] & domain));
    }
    begin = end;
  }
  for (std::size_t node = mesh.vertex_end[0]; node < sorted.size(); ++node) {
    const auto [a, b] = ordered.mesh.parents[node];
    CHECK(a < b);
    const Eigen::Vector3d middle =
        ordered.mesh.positions[static_cast<std::size_t>(a)] + ordered.mesh.positions[static_cast<std::size_t>(b)];
    CHECK((middle.normalized() - ordered.mesh.positions[node]).norm() < 1e-12);
  }
  CHECK(triangle_names(ordered.mesh) == triangle_names(mesh));
}

TEST_CASE("order_nodes brings neighbours together") {
  const auto mesh = test::icosphere(4);
  const auto ordered = order_nodes(mesh, std::vector<std::uint32_t>(mesh.positions.size(), domain));
  const auto mean_step = [](const SemiRegularMesh& m) {
    double sum = 0;
    for (std::size_t i = m.vertex_end[3] + 1; i < m.vertex_end[4]; ++i) {
      sum += (m.positions[i] - m.positions[i - 1]).norm();
    }
    return sum / static_cast<double>(m.vertex_end[4] - m.vertex_end[3] - 1);
  };
  // the finest level's nodes are about 0.08 apart
  CHECK(mean_step(ordered.mesh) < 0.16);
}

TEST_CASE("order_nodes is its own fixed point") {
  const auto mesh = test::blob(2);
  const std::vector<std::uint32_t> flags(mesh.positions.size(), domain);
  const auto once = order_nodes(mesh, flags);
  const auto twice = order_nodes(once.mesh, flags);
  CHECK(twice.mesh.positions == once.mesh.positions);
  CHECK(twice.mesh.parents == once.mesh.parents);
  CHECK(twice.mesh.base_triangles == once.mesh.base_triangles);
}

TEST_CASE("mark_domain closes the needed nodes under free parents and leaves fixed nodes out") {
  const auto mesh = test::icosphere(2);
  const std::size_t node = mesh.positions.size() - 1;
  const auto a = static_cast<std::size_t>(mesh.parents[node][0]);
  const auto b = static_cast<std::size_t>(mesh.parents[node][1]);
  std::vector<std::uint32_t> flags(mesh.positions.size(), 0);
  flags[node] = layout::node_touchable;
  flags[a] = layout::node_fixed | layout::node_read;
  const auto marked = mark_domain(mesh, flags);
  CHECK((marked[node] & domain) != 0);
  CHECK((marked[a] & domain) == 0);
  CHECK((marked[b] & domain) != 0);
  if (b >= mesh.vertex_end[0]) {
    for (const int grandparent : mesh.parents[b]) {
      const auto g = static_cast<std::size_t>(grandparent);
      CHECK(((marked[g] & domain) != 0) == (g != a));
    }
  }
  CHECK(std::count_if(marked.begin(), marked.end(), [](std::uint32_t f) { return (f & domain) != 0; }) <= 4);
}

TEST_CASE("node flags of another mesh are refused") {
  const auto mesh = test::icosphere(1);
  const std::vector<std::uint32_t> flags(mesh.positions.size() - 1, 0);
  CHECK_THROWS_AS((void)mark_domain(mesh, flags), std::invalid_argument);
  CHECK_THROWS_AS((void)order_nodes(mesh, flags), std::invalid_argument);
}

}  // namespace
}  // namespace greenloop::offline
