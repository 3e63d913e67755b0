#include "sim_hw/body/body_surface.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <set>
#include <stdexcept>
#include <utility>

#include "formats/testing/synthetic_model.hpp"
#include "formats/write/aligned_bytes.hpp"

namespace greenloop {
namespace {

/// The surface of the synthetic sphere, after its model went through a file.
BodySurface surface_of(const ModelData& data) {
  const auto encoded = encode(data);
  const AlignedBytes bytes(encoded);
  const auto opened = Model::open(bytes.span());
  REQUIRE(opened);
  return body_surface(opened.model);
}

TEST_CASE("the refined octahedron comes back closed and facing outwards") {
  const BodySurface surface = surface_of(synthetic_model({.levels = 4}));
  CHECK(surface.triangles.size() == 8 * 64);
  CHECK(surface.position.size() == 258);
  std::set<std::pair<std::uint32_t, std::uint32_t>> half_edges;
  for (const Surface::Triangle& triangle : surface.triangles) {
    const auto& [a, b, c] = triangle.node;
    for (const auto& half_edge : {std::pair{a, b}, std::pair{b, c}, std::pair{c, a}}) {
      CHECK(half_edges.insert(half_edge).second);
    }
  }
  for (const auto& [a, b] : half_edges) CHECK(half_edges.count({b, a}) == 1);
  for (std::size_t i = 0; i < surface.position.size(); ++i) {
    CHECK(dot(surface.normal[i], unit(surface.position[i])) > 0.98);
  }
}

TEST_CASE("size and spacing are those of the sphere") {
  const BodySurface surface = surface_of(synthetic_model({.levels = 4}));
  CHECK(norm(surface.centre) < 1e-8);
  CHECK(surface.diagonal == doctest::Approx(0.2 * std::sqrt(3.0)));
  CHECK(surface.spacing > 0.015);
  CHECK(surface.spacing < 0.025);
}

TEST_CASE("the touchable nodes are those of the scene") {
  const BodySurface surface = surface_of(synthetic_model({.levels = 3, .touchable_above = 0.25}));
  for (std::size_t i = 0; i < surface.position.size(); ++i) {
    CHECK(surface.touchable[i] == (surface.position[i].z >= 0.025));
  }
}

TEST_CASE("a refinement that leaves an edge without its midpoint is refused") {
  ModelData data = synthetic_model({.levels = 2});
  auto& refinement = data.levels[1].refinement;
  std::copy_n(refinement[0].parent, 2, refinement[1].parent);
  CHECK_THROWS_AS((void)surface_of(data), std::runtime_error);
}

}  // namespace
}  // namespace greenloop
