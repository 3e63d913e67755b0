#include "offline/surface/surface_report.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "offline/surface/test_surfaces.hpp"

using namespace greenloop;
using namespace greenloop::offline;

namespace {

struct Expected {
  std::string file;
  std::size_t vertices;
  std::size_t triangles;
  bool closed;
  std::size_t components;
  int euler;
  double quality;
  std::size_t intersections;
};

void check_file(const Expected& expected) {
  CAPTURE(expected.file);
  const auto report = check_surface(fetched_surface(expected.file));
  CHECK(report.vertex_count == expected.vertices);
  CHECK(report.triangle_count == expected.triangles);
  CHECK(report.closed() == expected.closed);
  CHECK(report.manifold());
  CHECK(report.component_sizes.size() == expected.components);
  CHECK(report.euler_characteristic == expected.euler);
  CHECK(std::abs(report.worst_quality - expected.quality) <= 0.05 * expected.quality);
  CHECK(report.intersecting_faces.size() == expected.intersections);
}

}  // namespace

TEST_CASE("the cube") {
  const auto report = check_surface(cube());
  CHECK(report.closed());
  CHECK(report.manifold());
  CHECK(report.oriented());
  CHECK_FALSE(report.inward());
  CHECK(report.component_sizes == std::vector<std::size_t>{12});
  CHECK(report.euler_characteristic == 2);
  CHECK(report.genus() == 0);
  CHECK(report.volume == doctest::Approx(1));
  CHECK(report.area == doctest::Approx(6));
  CHECK(report.worst_quality == doctest::Approx(0.5));
  CHECK(report.intersecting_faces.empty());
  CHECK(describe_defects(cube(), report).empty());
}

TEST_CASE("files whose properties are known") {
  check_file({"meshes/bear_bis.off", 10096, 20188, true, 1, 2, 0.22, 0});
  check_file({"bunny.obj", 1839, 3674, true, 1, 2, 0.131, 0});
  check_file({"meshes/cactus.off", 620, 1236, true, 1, 2, 0.25, 0});
  check_file({"meshes/elephant.off", 2775, 5558, true, 1, -4, 0.297, 0});
  check_file({"meshes/hand.off", 1197, 2390, true, 1, 2, 0.00625, 0});
  check_file({"meshes/knot1.off", 3200, 6400, true, 1, 0, 0.38, 0});
  check_file({"meshes/geosphere.off", 162, 320, true, 1, 2, 0.7, 0});
  check_file({"meshes/cow.off", 2904, 5804, true, 1, 2, 0.0275, 89});
  check_file({"meshes/triceratops.off", 2832, 5660, true, 1, 2, 1.75e-6, 0});
  check_file({"meshes/tetra_intersected_by_triangle.off", 7, 5, false, 2, 3, 0.14, 1});
  check_file({"meshes/degtri_sliding.off", 8, 8, false, 1, 1, 0, 3});
}

TEST_CASE("genus of the elephant and of the knot") {
  CHECK(check_surface(fetched_surface("meshes/elephant.off")).genus() == 3);
  CHECK(check_surface(fetched_surface("meshes/knot1.off")).genus() == 1);
}

TEST_CASE("volume of the teddy bear") {
  CHECK(check_surface(fetched_surface("meshes/bear_bis.off")).volume == doctest::Approx(0.4158).epsilon(1e-3));
}

TEST_CASE("faces of zero area") {
  const auto report = check_surface(fetched_surface("meshes/degtri_sliding.off"));
  CHECK(report.zero_area_faces.size() == 4);
  CHECK(report.boundary_edges.size() == 6);
}

TEST_CASE("one of the cow's vertices lies on another") {
  CHECK(check_surface(fetched_surface("meshes/cow.off")).duplicate_vertices.size() == 1);
}

TEST_CASE("an inward surface has a negative volume") {
  const auto report = check_surface(fetched_surface("meshes/tetrahedron.off"));
  CHECK(report.inward());
  CHECK(report.volume == doctest::Approx(-1.0 / 6));
}

TEST_CASE("holes are open edges") {
  const auto report = check_surface(fetched_surface("meshes/elephant-with-holes.off"));
  CHECK_FALSE(report.closed());
}

TEST_CASE("a missing face leaves three boundary edges") {
  auto mesh = cube();
  mesh.triangles.pop_back();  // {1, 7, 5}
  const auto report = check_surface(mesh);
  CHECK(report.boundary_edges == std::vector<std::array<int, 2>>{{1, 5}, {1, 7}, {5, 7}});
  CHECK(report.volume == 0);
}

TEST_CASE("a wall inside makes non-manifold edges") {
  auto mesh = cube();
  mesh.triangles.push_back({0, 1, 7});  // the edges 0-1 and 1-7 have two faces already, 0-7 none
  const auto report = check_surface(mesh);
  CHECK(report.non_manifold_edges == std::vector<std::array<int, 2>>{{0, 1}, {1, 7}});
  CHECK(report.boundary_edges == std::vector<std::array<int, 2>>{{0, 7}});
}

TEST_CASE("two cubes that share a corner have one non-manifold vertex") {
  auto mesh = joined(cube(), cube(Eigen::Vector3d::Ones()));
  for (auto& triangle : mesh.triangles) {
    for (int& vertex : triangle) {
      vertex = vertex == 8 ? 7 : vertex;
    }
  }
  const auto report = check_surface(mesh);
  CHECK(report.non_manifold_vertices == std::vector<int>{7});
  CHECK(report.unreferenced_vertices == std::vector<int>{8});
  CHECK(report.component_sizes == std::vector<std::size_t>{12, 12});
}

TEST_CASE("a face turned over disagrees along its three edges") {
  auto mesh = cube();
  std::swap(mesh.triangles[0][0], mesh.triangles[0][1]);
  const auto report = check_surface(mesh);
  CHECK(report.misoriented_edges.size() == 3);
  CHECK_FALSE(report.oriented());
}

TEST_CASE("a face twice, in another order") {
  auto mesh = cube();
  mesh.triangles.push_back({3, 0, 2});
  CHECK(check_surface(mesh).duplicate_faces == std::vector<std::array<int, 2>>{{12, 0}});
}

TEST_CASE("a face with a repeated vertex has no area") {
  auto mesh = cube();
  mesh.triangles.push_back({3, 3, 2});
  CHECK(check_surface(mesh).zero_area_faces == std::vector<int>{12});
}

TEST_CASE("two cubes through each other intersect") {
  const auto report = check_surface(joined(cube(), cube(Eigen::Vector3d::Constant(0.5))));
  CHECK(report.component_sizes.size() == 2);
  CHECK(report.intersecting_faces.size() >= 12);
  CHECK(report.euler_characteristic == 4);
}

TEST_CASE("nothing at all") {
  const auto report = check_surface({});
  CHECK(report.component_sizes.empty());
  CHECK(report.worst_face == -1);
  CHECK(describe_defects({}, report) == std::vector<std::string>{"no faces at all"});
}
