#include "offline/multigrid/coarsen.hpp"

#include <doctest/doctest.h>

#include <Eigen/LU>
#include <algorithm>
#include <set>

#include "offline/volume/testing/shapes.hpp"
#include "offline/volume/tetrahedralize.hpp"

namespace greenloop::offline {
namespace {

using Eigen::Vector3d;

double volume_of(const TetrahedralMesh& mesh) {
  double sum = 0.0;
  for (const auto& t : mesh.tetrahedra) {
    Eigen::Matrix3d edges;
    for (int a = 0; a < 3; ++a) edges.col(a) = mesh.vertices[t[a + 1]] - mesh.vertices[t[0]];
    CHECK(edges.determinant() > 0.0);
    sum += edges.determinant() / 6.0;
  }
  return sum;
}

TEST_CASE("eight children fill a tetrahedron and share the middles of edges") {
  const TetrahedralMesh coarse = testing::box(Eigen::Vector3i(2, 2, 1), Vector3d(2, 1, 1));
  const TetrahedralMesh fine = refined(coarse);
  CHECK(fine.tetrahedra.size() == 8 * coarse.tetrahedra.size());
  CHECK(volume_of(fine) == doctest::Approx(2.0));
  CHECK(std::equal(coarse.vertices.begin(), coarse.vertices.end(), fine.vertices.begin()));
  // cells of half the size have their corners there and nowhere else
  CHECK(fine.vertices.size() == std::size_t{5 * 5 * 3});
}

TEST_CASE("a lattice covers a body") {
  const TetrahedralMesh body = testing::shell(2, 2, 0.9, 1.0);
  const TetrahedralMesh cubes = lattice(body, 0.25);
  const double volume = volume_of(cubes);
  CHECK(volume > volume_of(body));
  CHECK(volume < 8.0);  // not the middle
  CHECK_THROWS_AS((void)lattice(body, 0.0), std::invalid_argument);
}

TEST_CASE("a body has coarser meshes, down to a few hundred vertices") {
  const TriangleMesh surface = testing::torus(1.0, 0.4, 48, 24);
  const TetrahedralMesh body = tetrahedralize(surface).mesh;
  const CoarserMeshes coarser = coarsen(surface, body, 200);
  CHECK(coarser.note.empty());
  REQUIRE(!coarser.meshes.empty());
  std::size_t before = body.vertices.size();
  for (const TetrahedralMesh& mesh : coarser.meshes) {
    CHECK(2 * mesh.vertices.size() <= before);
    CHECK(volume_of(mesh) == doctest::Approx(volume_of(body)).epsilon(0.3));
    before = mesh.vertices.size();
  }
  CHECK(before <= 200);
}

TEST_CASE("where surfaces cannot be meshed lattices follow, and a note says so") {
  // the surface of another body, which crosses itself
  TriangleMesh crossing = testing::torus(1.0, 0.4, 24, 12);
  for (Vector3d& vertex : crossing.vertices) vertex.x() = std::abs(vertex.x());
  const TetrahedralMesh body = testing::box(Eigen::Vector3i::Constant(8), Vector3d::Ones());
  const CoarserMeshes coarser = coarsen(crossing, body, 100);
  CHECK(coarser.note.find("lattices") != std::string::npos);
  REQUIRE(!coarser.meshes.empty());
  CHECK(coarser.meshes.back().vertices.size() <= 100);
}

}  // namespace
}  // namespace greenloop::offline
