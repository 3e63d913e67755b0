#include "offline/surface/surface_preparation.hpp"

#include <doctest/doctest.h>

#include <initializer_list>
#include <random>
#include <string_view>

#include "offline/surface/test_surfaces.hpp"

using namespace greenloop;
using namespace greenloop::offline;

namespace {

/// Refused with exactly these defects, each containing its piece.
void check_refused(const TriangleMesh& mesh, std::initializer_list<std::string_view> pieces) {
  try {
    static_cast<void>(prepare_surface(mesh));
    FAIL("accepted");
  } catch (const SurfaceError& error) {
    CAPTURE(std::string(error.what()));
    REQUIRE(error.defects().size() == pieces.size());
    auto defect = error.defects().begin();
    for (const auto piece : pieces) {
      CAPTURE(piece);
      CHECK(defect->find(piece) != std::string::npos);
      CHECK(std::string_view(error.what()).find(*defect++) != std::string_view::npos);
    }
  }
}

using Eigen::Vector3d;
using Repairs = std::vector<std::string>;

}  // namespace

TEST_CASE("sound surfaces pass unchanged") {
  for (const auto* name : {"meshes/bear_bis.off", "bunny.obj", "meshes/elephant.off", "meshes/triceratops.off"}) {
    CAPTURE(name);
    const auto mesh = fetched_surface(name);
    const auto prepared = prepare_surface(mesh);
    CHECK(prepared.repairs.empty());
    CHECK(prepared.mesh.vertices == mesh.vertices);
    CHECK(prepared.mesh.triangles == mesh.triangles);
  }
}

TEST_CASE("an inward surface is turned") {
  const auto prepared = prepare_surface(fetched_surface("meshes/tetrahedron.off"));
  CHECK(prepared.repairs == Repairs{"all faces looked inwards and were turned outwards"});
  CHECK(prepared.report.volume == check_surface(prepared.mesh).volume);
  CHECK(prepared.report.volume == doctest::Approx(1.0 / 6));
}

TEST_CASE("faces that disagree are turned") {
  auto mesh = cube();
  std::swap(mesh.triangles[3][0], mesh.triangles[3][1]);
  std::swap(mesh.triangles[7][0], mesh.triangles[7][1]);
  const auto prepared = prepare_surface(mesh);
  CHECK(prepared.repairs == Repairs{"2 faces turned to agree with their neighbours"});
  CHECK(prepared.report.volume == doctest::Approx(1));
}

TEST_CASE("the minority is turned, then all if that looks inwards") {
  auto mesh = cube();
  for (std::size_t f = 0; f < 11; ++f) {
    std::swap(mesh.triangles[f][0], mesh.triangles[f][1]);
  }
  const auto prepared = prepare_surface(mesh);
  CHECK(prepared.repairs ==
        Repairs{"1 face turned to agree with their neighbours", "all faces looked inwards and were turned outwards"});
  CHECK(prepared.report.volume == doctest::Approx(1));
}

TEST_CASE("vertices in no face are dropped") {
  auto mesh = cube();
  mesh.vertices.insert(mesh.vertices.begin(), Eigen::Vector3d(5, 5, 5));
  for (auto& triangle : mesh.triangles) {
    for (int& vertex : triangle) {
      ++vertex;
    }
  }
  const auto prepared = prepare_surface(mesh);
  CHECK(prepared.repairs == Repairs{"1 vertex in no face dropped"});
  CHECK(prepared.mesh.vertices == cube().vertices);
  CHECK(prepared.mesh.triangles == cube().triangles);
}

TEST_CASE("a soup of faces is merged") {
  const auto prepared = prepare_surface(soup(cube()));
  CHECK(prepared.repairs == Repairs{"28 vertices at exactly the same position as another merged into it"});
  CHECK(prepared.mesh.vertices.size() == 8);
  CHECK(prepared.report.volume == doctest::Approx(1));
}

TEST_CASE("a soup whose seams do not quite meet is welded, by the shortest distance that closes it, seed 5") {
  std::mt19937_64 random(5);
  for (const double noise : {1e-17, 1e-14, 1e-10, 1e-8, 4e-7, 1e-6, 4e-6}) {
    CAPTURE(noise);
    auto mesh = soup(cube());
    for (auto& vertex : mesh.vertices) {
      for (double& x : vertex) {
        x += noise * (static_cast<double>(random() % 3) - 1);
      }
    }
    const auto prepared = prepare_surface(mesh);
    CHECK(prepared.mesh.vertices.size() == 8);
    CHECK(prepared.mesh.triangles.size() == 12);
    CHECK(prepared.report.volume == doctest::Approx(1));
    REQUIRE(prepared.repairs.size() == 1);
    CHECK(prepared.repairs[0].find("28 vertices within ") == 0);
    CHECK_THROWS_AS(prepare_surface(mesh, 0), SurfaceError);
    CHECK(prepare_surface(mesh, 1e-4).mesh.vertices.size() == 8);
  }
}

TEST_CASE("no real face is collapsed by a weld that nobody asked for") {
  auto needle = soup(cube());
  needle.vertices[1] += Vector3d(3e-6, 0, 0);  // a seam that only a weld longer than the little face below would close
  const Vector3d tip = needle.vertices[0];
  const int first = static_cast<int>(needle.vertices.size());
  for (const double x : {0.0, 1e-7, 2e-7}) needle.vertices.push_back(tip + Vector3d(x, x * x, x));
  needle.triangles.push_back({first, first + 1, first + 2});
  CHECK_THROWS_AS(prepare_surface(needle), SurfaceError);
}

TEST_CASE("a weld that was asked for drops and counts the faces that it collapses") {
  auto mesh = cube();  // a corner cut off, 0.001 long
  mesh.vertices.push_back({0.001, 0, 0});
  mesh.vertices.push_back({0, 0.001, 0});
  mesh.vertices.push_back({0, 0, 0.001});
  mesh.triangles = {{9, 2, 3}, {9, 3, 8}, {8, 3, 1},  {4, 5, 7},  {4, 7, 6}, {8, 1, 5}, {8, 5, 10}, {10, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {10, 4, 6}, {10, 6, 9}, {9, 6, 2}, {1, 3, 7}, {1, 7, 5},  {8, 10, 9}};
  CHECK(prepare_surface(mesh).mesh.triangles.size() == 16);
  const auto welded = prepare_surface(mesh, 0.002);
  CHECK(welded.mesh.triangles.size() == 12);
  CHECK(welded.mesh.vertices.size() == 8);
  REQUIRE(welded.repairs.size() >= 2);
  CHECK(welded.repairs[0].find("vertices within 0.002 of another welded to it") != std::string::npos);
  CHECK(welded.repairs[1] == "4 faces without an area left dropped");
}

TEST_CASE("sheets that lie close to each other are not welded to one") {
  TriangleMesh stack;
  for (int i = 0; i < 8; ++i)
    stack = joined(stack, {{{0, 0, 1e-6 * i}, {1, 0, 1e-6 * i}, {0, 1, 1e-6 * i}}, {{0, 1, 2}}});
  check_refused(stack, {"24 boundary edges", "several pieces: 8"});
}

TEST_CASE("a face twice is dropped") {
  auto mesh = cube();
  mesh.triangles.push_back({3, 0, 2});
  const auto prepared = prepare_surface(mesh);
  CHECK(prepared.repairs == Repairs{"1 face that occurs twice dropped"});
  CHECK(prepared.mesh.triangles == cube().triangles);
}

TEST_CASE("a soup with a face twice is merged, then dropped") {
  auto mesh = cube();
  mesh.triangles.push_back({3, 0, 2});
  const auto prepared = prepare_surface(soup(mesh));
  CHECK(prepared.repairs.size() == 2);
  CHECK(prepared.mesh.triangles.size() == 12);
}

TEST_CASE("vertices that touch in a closed surface are left alone") {
  const auto report = check_surface(fetched_surface("meshes/cow.off"));
  REQUIRE(report.duplicate_vertices.size() == 1);
  check_refused(fetched_surface("meshes/cow.off"), {"89 pairs of faces that intersect: faces 260 and 4706 at (-0.4"});
}

TEST_CASE("refused: an open surface") {
  auto mesh = cube();
  mesh.triangles.pop_back();
  check_refused(mesh, {"3 boundary edges (the surface is open): face 4 between (1, 0, 0) and (1, 0, 1)"});
}

TEST_CASE("refused: a seam whose merging does not close the surface") {
  auto mesh = cube();
  mesh.triangles.pop_back();
  check_refused(soup(mesh), {"33 boundary edges", "11 that share no edge"});
}

TEST_CASE("refused: non-manifold edges") {
  auto mesh = cube();
  mesh.triangles.push_back({0, 1, 7});
  check_refused(mesh,
                {"1 boundary edge (the surface is open): face 12 between",
                 "2 non-manifold edges (of more than two faces): faces 1, 4, 12 between (0, 0, 0) and (1, 0, 0)"});
}

TEST_CASE("refused: a non-manifold vertex") {
  auto mesh = joined(cube(), cube(Eigen::Vector3d::Ones()));
  for (auto& triangle : mesh.triangles) {
    for (int& vertex : triangle) {
      vertex = vertex == 8 ? 7 : vertex;
    }
  }
  check_refused(mesh,
                {"1 non-manifold vertex (where sheets meet in a point): (1, 1, 1) in faces 2, 3, 6", "several pieces"});
}

TEST_CASE("refused: several pieces") {
  check_refused(
      joined(cube(), cube(Eigen::Vector3d(3, 0, 0))),
      {"several pieces: 2 that share no edge, of 12 faces (face 0 at (0.333333, 0.666667, 0)), 12 faces (face 12"});
}

TEST_CASE("refused: pieces that intersect") {
  check_refused(joined(cube(), cube(Eigen::Vector3d::Constant(0.5))),
                {"several pieces", "pairs of faces that intersect"});
}

TEST_CASE("refused: a face of zero area") {
  auto mesh = cube();
  // a vertex in the middle of the edge 0-3, joined to it only
  mesh.vertices.emplace_back(0.5, 0.5, 0);
  mesh.triangles[1] = {0, 8, 1};
  mesh.triangles.push_back({8, 3, 1});
  mesh.triangles.push_back({0, 3, 8});
  check_refused(mesh,
                {"1 face of zero area: face 13 at (0.5, 0.5, 0)", "2 pairs of faces that intersect: faces 0 and 1"});
}

TEST_CASE("refused: a tetrahedron crossed by a triangle") {
  check_refused(fetched_surface("meshes/tetra_intersected_by_triangle.off"),
                {"3 boundary edges", "several pieces: 2", "1 pair of faces that intersect: faces 2 and 4"});
}

TEST_CASE("refused: faces that slid flat") {
  check_refused(fetched_surface("meshes/degtri_sliding.off"), {"6 boundary edges", "4 faces of zero area", "3 pairs"});
}

TEST_CASE("refused: holes in the elephant") {
  check_refused(fetched_surface("meshes/elephant-with-holes.off"), {"boundary edges (the surface is open): face"});
}

TEST_CASE("refused: a surface without inside") {
  const TriangleMesh pillow{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 1}}};
  check_refused(pillow, {"1 face that occurs twice", "1 pair of faces that intersect"});
}

TEST_CASE("refused: a Klein bottle has no outside") {
  // a grid of 6 x 6 quads, closed to a tube in u, and in v with u mirrored; immersed, so it meets itself
  constexpr int n = 6;
  TriangleMesh mesh;
  for (int v = 0; v < n; ++v) {
    for (int u = 0; u < n; ++u) {
      mesh.vertices.emplace_back(u + 0.1 * v * v, v + 0.07 * u * u, 0.3 * u * v + 0.05 * u * u * u);
    }
  }
  const auto vertex = [&](int u, int v) { return v == n ? (n - u % n) % n : v * n + u % n; };
  for (int v = 0; v < n; ++v) {
    for (int u = 0; u < n; ++u) {
      const int a = vertex(u, v), b = vertex(u + 1, v), c = vertex(u + 1, v + 1), d = vertex(u, v + 1);
      mesh.triangles.push_back({a, b, c});
      mesh.triangles.push_back({a, c, d});
    }
  }
  const auto report = check_surface(mesh);
  REQUIRE(report.closed());
  REQUIRE(report.manifold());
  REQUIRE(report.euler_characteristic == 0);
  try {
    static_cast<void>(prepare_surface(mesh));
    FAIL("accepted");
  } catch (const SurfaceError& error) {
    CHECK(std::string_view(error.what()).find("(it is not orientable)") != std::string_view::npos);
  }
}
