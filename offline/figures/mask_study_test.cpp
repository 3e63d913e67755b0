#include "offline/figures/mask_study.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace greenloop::offline {
namespace {

TEST_CASE("a vertex by itself grows soft as the mesh is refined, a mask does not") {
  const std::vector<RefinedStiffness> rows = refine_stiffness(3, 2, Elements::linear);
  REQUIRE(rows.size() == 3);
  for (const RefinedStiffness& row : rows) {
    MESSAGE(row.vertices << " vertices: " << row.single << " N/m, masked " << row.masked << " N/m, held mask "
                         << row.held << " N/m");
  }
  CHECK(rows[2].vertices == 642);
  CHECK(rows[2].single < 0.75 * rows[1].single);
  CHECK(std::abs(rows[2].held / rows[1].held - 1) <= 0.1);
}

TEST_CASE("masks take the ripple out of sliding over an uneven triangulation") {
  MaskedBody body(make_nodule({.splits = 3, .uneven = 0.3}), Elements::linear);
  const SlidingForce force = slide_around(body, 0.8, 2 * mean_edge(body.nodule().surface), 180);
  const double single = SlidingForce::ripple(force.single), masked = SlidingForce::ripple(force.held);
  MESSAGE("ripple " << 100 * single << " %, with masks " << 100 * masked << " %");
  CHECK(single > 0.1);
  CHECK(masked <= single / 5);
}

TEST_CASE("the nodule's vertices lie on the body, whose normals stand on it") {
  const Nodule nodule = make_nodule({.splits = 2, .uneven = 0.3});
  CHECK(nodule.surface.vertices.size() == 162);
  for (const Eigen::Vector3d& vertex : nodule.surface.vertices) {
    const double polar = std::acos(vertex.z() / vertex.norm()), azimuth = std::atan2(vertex.y(), vertex.x());
    CHECK((nodule_point(polar, azimuth) - vertex).norm() <= 1e-9);
    CHECK(nodule_normal(polar + 1e-3, azimuth).dot(vertex) > 0);
  }
}

}  // namespace
}  // namespace greenloop::offline
