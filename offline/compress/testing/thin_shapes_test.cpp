#include "offline/compress/testing/thin_shapes.hpp"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <map>
#include <utility>

#include "offline/compress/testing/measured_model.hpp"
#include "offline/compress/testing/solved_body.hpp"

namespace greenloop::offline {
namespace {

// every edge has one triangle on each side and the outside is outside
void check_closed(const SemiRegularMesh& mesh, int holes) {
  const auto triangles = triangles_of_level(mesh, mesh.finest_level());
  std::map<std::pair<int, int>, int> edges;
  double volume = 0;
  for (const auto& [a, b, c] : triangles) {
    for (const auto& edge : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) ++edges[edge];
    const auto at = [&](int node) { return mesh.positions[static_cast<std::size_t>(node)]; };
    volume += at(a).dot(at(b).cross(at(c))) / 6;
  }
  for (const auto& [edge, count] : edges) {
    REQUIRE(count == 1);
    REQUIRE(edges.contains({edge.second, edge.first}));
  }
  CHECK(volume > 0);
  CHECK(mesh.positions.size() + triangles.size() + 2 * static_cast<std::size_t>(holes) == edges.size() / 2 + 2);
}

// filled with tetrahedra, which refuses surfaces that intersect themselves, solved and built; how many times as many
// blocks lifted Linear wavelets keep as Equilibrated ones
double check_built(const SemiRegularMesh& mesh, const test::Region& fixed) {
  const auto body = test::solve_body(mesh, fixed, {1e5, 0.3});
  double blocks[2] = {};
  for (const bool equilibrated : {false, true}) {
    CAPTURE(equilibrated);
    const auto model =
        test::measure_model(body, equilibrated ? layout::Wavelet::equilibrated : layout::Wavelet::lifted_linear);
    CHECK(model.patch_force <= test::default_accuracy.patch_force);
    CHECK(model.certified);
    CHECK(model.definite);
    blocks[equilibrated ? 1 : 0] = static_cast<double>(model.built.report.levels.back().kept_blocks);
  }
  MESSAGE("lifted Linear wavelets keep ", blocks[0] / blocks[1], " times as many blocks as Equilibrated ones");
  return blocks[0] / blocks[1];
}

TEST_CASE("thin shapes are closed surfaces at every level") {
  for (int levels = 0; levels <= 4; ++levels) {
    check_closed(test::ear(levels), 0);
    check_closed(test::bowl(levels), 0);
    check_closed(test::handle(levels), 1);
    check_closed(test::web(levels), 0);
  }
}

TEST_CASE("an ear is built, as accurate as asked") {
  CHECK(check_built(test::ear(3), [](const Eigen::Vector3d& x) { return x.z() < -0.6; }) > 1.2);
}

TEST_CASE("a bowl is built, as accurate as asked") {
  CHECK(check_built(test::bowl(3), [](const Eigen::Vector3d& x) { return x.z() < 0.06; }) > 1.2);
}

TEST_CASE("a body with a handle is built, as accurate as asked") {
  CHECK(check_built(test::handle(2), [](const Eigen::Vector3d& x) { return x.x() < -1.5; }) > 1.2);
}

TEST_CASE("a web is built, as accurate as asked") {
  CHECK(check_built(test::web(3), [](const Eigen::Vector3d& x) { return x.x() < -0.8; }) > 1.2);
}

}  // namespace
}  // namespace greenloop::offline
