#include "formats/mesh/model_surface.hpp"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "formats/testing/model_mutant.hpp"

namespace greenloop {
namespace {

double enclosed_volume(const TriangleMesh& mesh) {
  double volume = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    volume += mesh.vertices[a].dot(mesh.vertices[b].cross(mesh.vertices[c])) / 6;
  }
  return volume;
}

TEST_CASE("model surface: the synthetic model's is a sphere seen from outside, at every level") {
  double previous = 0;
  for (std::uint32_t levels = 1; levels <= 5; ++levels) {
    ModelMutant model(
        SyntheticOptions{.levels = levels, .coarsest_constraint_level = levels - 1, .touchable_above = 1});
    REQUIRE(model.verdict().ok());
    const TriangleMesh mesh = finest_surface(model.view());
    CHECK(mesh.vertices.size() == model.view().node_count);
    CHECK(mesh.triangles.size() == 2 * mesh.vertices.size() - 4);  // Euler, genus 0
    const double volume = enclosed_volume(mesh);
    CHECK(volume > previous);
    previous = volume;
  }
  CHECK(previous == doctest::Approx(4.0 / 3.0 * M_PI * 1e-3).epsilon(0.02));
}

TEST_CASE("model surface: a cut model's is the coarser level") {
  const auto whole = encode(synthetic_model({.levels = 4}));
  ModelMutant model(truncate_to_level(whole, 2));
  REQUIRE(model.verdict().ok());
  const SemiRegularMesh mesh = semi_regular_surface(model.view());
  CHECK(mesh.vertex_end == std::vector<std::size_t>{6, 18, 66});
  CHECK(mesh.finest_level() == 2);
}

}  // namespace
}  // namespace greenloop
