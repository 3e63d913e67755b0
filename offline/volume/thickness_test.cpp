#include "offline/volume/thickness.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "offline/volume/testing/shapes.hpp"
#include "offline/volume/tetrahedralize.hpp"

namespace greenloop::offline {
namespace {

std::vector<double> elements_of(const std::vector<Chord>& chords) {
  std::vector<double> elements;
  for (const Chord& chord : chords) elements.push_back(chord.elements());
  return elements;
}

TEST_CASE("chords of an ellipsoid go through it") {
  const Eigen::Vector3d axes(1, 1, 0.2);
  const SemiRegularMesh surface = testing::ellipsoid(3, axes);
  const auto chords = inward_chords(surface);
  REQUIRE(chords.size() == surface.positions.size());
  double shortest = 2;
  for (std::size_t node = 0; node < chords.size(); ++node) {
    REQUIRE(chords[node].triangle >= 0);
    // the normal of the ellipsoid, and where it leaves
    const Eigen::Vector3d& p = surface.positions[node];
    const Eigen::Vector3d d = -p.cwiseQuotient(axes.cwiseAbs2()).normalized();
    const Eigen::Vector3d q = p.cwiseQuotient(axes), e = d.cwiseQuotient(axes);
    const double exact = -2 * q.dot(e) / e.squaredNorm();
    CHECK(chords[node].length == doctest::Approx(exact).epsilon(0.12));
    shortest = std::min(shortest, chords[node].length);
  }
  CHECK(shortest < 0.4);
}

TEST_CASE("the thinnest part of a flat body, before and after it is filled") {
  const SemiRegularMesh flat = testing::ellipsoid(3, {1, 1, 0.1});
  const auto chords = inward_chords(flat);
  const ThinnestPart estimate = thinnest_part(flat, elements_of(chords));
  CHECK(estimate.elements < 2);
  const auto filled = tetrahedralize(finest_surface(flat));
  const auto interpolation =
      select_first_vertices(static_cast<int>(flat.positions.size()), static_cast<int>(filled.mesh.vertices.size()));
  const ThinnestPart counted = thinnest_part(flat, layers_along(chords, flat, {}, filled.mesh, interpolation));
  CHECK(counted.elements >= 1);
  CHECK(counted.elements <= 2);
}

TEST_CASE("a ball has nothing thin") {
  const SemiRegularMesh ball = testing::ellipsoid(3, {1, 1, 1});
  const ThinnestPart thinnest = thinnest_part(ball, elements_of(inward_chords(ball)));
  CHECK(thinnest.elements > 8);
}

TEST_CASE("layers are counted through the tetrahedra") {
  const SemiRegularMesh octahedron{
      .positions = {{2, 1, 0.5}, {1, 2, 0.5}, {0, 1, 0.5}, {1, 0, 0.5}, {1, 1, 1}, {1, 1, 0}},
      .vertex_end = {6},
      .parents = std::vector<std::array<int, 2>>(6, {-1, -1}),
      .base_triangles = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}, {1, 0, 5}, {2, 1, 5}, {3, 2, 5}, {0, 3, 5}}};
  const TetrahedralMesh volume = testing::box({4, 4, 2}, {2, 2, 1});
  const auto interpolation = [&] {
    Interpolation weights(6, static_cast<Eigen::Index>(volume.vertices.size()));
    for (int node = 0; node < 6; ++node) {
      for (std::size_t v = 0; v < volume.vertices.size(); ++v) {
        if ((volume.vertices[v] - octahedron.positions[node]).norm() < 1e-9)
          weights.insert(node, static_cast<int>(v)) = 1;
      }
    }
    return weights;
  }();
  REQUIRE(interpolation.nonZeros() == 6);
  const std::vector<Chord> down{{}, {}, {}, {}, {.triangle = 4, .length = 1, .spacing = 1}, {}};
  const auto layers = layers_along(down, octahedron, {}, volume, interpolation);
  CHECK(layers[4] == 2);
  CHECK(layers[0] == most_layers);
}

}  // namespace
}  // namespace greenloop::offline
