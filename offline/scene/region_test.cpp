#include "offline/scene/region.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <string>

#include "formats/mesh/surface_io.hpp"
#include "offline/scene/scene.hpp"

using namespace greenloop::offline;
using Eigen::Vector3d;

namespace {

/// Corners of a box of 2 m x 4 m x 1 m away from the origin, x fastest.
struct Fixture {
  std::vector<Vector3d> positions;
  Eigen::AlignedBox3d box{Vector3d(10, 20, 30), Vector3d(12, 24, 31)};

  Fixture() {
    for (const double z : {30.0, 31.0}) {
      for (const double y : {20.0, 24.0}) {
        for (const double x : {10.0, 12.0}) {
          positions.emplace_back(x, y, z);
        }
      }
    }
  }

  [[nodiscard]] std::string flags(const Region& region) const { return text(evaluate(region, positions, box)); }

  static std::string text(const std::vector<bool>& flags) {
    std::string result;
    for (const bool flag : flags) {
      result += flag ? '1' : '0';
    }
    return result;
  }
};

Scene scene_with(const std::string& regions) {
  return parse_scene("[surface]\nfile = \"a.off\"\nunit = \"m\"\n[material]\nyoung = \"1 Pa\"\npoisson = 0\n" + regions,
                     "s.toml");
}

std::string refusal(const Scene& scene, const Fixture& body) {
  try {
    static_cast<void>(select_nodes(scene, body.positions, body.box));
  } catch (const SceneError& error) {
    return error.what();
  }
  return "";
}

const std::string lower_half = "[[fixed]]\nbelow = 0.5\naxis = \"y\"\n";

}  // namespace

TEST_CASE_FIXTURE(Fixture, "half spaces include their boundary") {
  CHECK(flags(HalfSpace{1, true, 0.5}) == "11001100");
  CHECK(flags(HalfSpace{1, false, 0.5}) == "00110011");
  CHECK(flags(HalfSpace{0, true, 0}) == "10101010");
  CHECK(flags(HalfSpace{2, false, 1}) == "00001111");
  CHECK(flags(HalfSpace{2, true, 1}) == "11111111");
}

TEST_CASE_FIXTURE(Fixture, "boxes are in fractions of the bounding box") {
  CHECK(flags(BoxRegion{Vector3d(0.5, 0, 0), Vector3d(1, 1, 0.5)}) == "01010000");
}

TEST_CASE_FIXTURE(Fixture, "spheres have a radius in metres or in fractions of the longest side") {
  CHECK(flags(SphereRegion{Vector3d::Zero(), 1, true}) == "10001000");
  CHECK(flags(SphereRegion{Vector3d::Zero(), 0.5, false}) == "11001000");
  CHECK(flags(SphereRegion{Vector3d::Zero(), 0.99, true}) == "10000000");
}

TEST_CASE_FIXTURE(Fixture, "the nearest nodes, smaller indices first") {
  CHECK(flags(NearestRegion{Vector3d::Ones(), 1}) == "00000001");
  CHECK(flags(NearestRegion{Vector3d::Constant(0.5), 3}) == "11100000");
  CHECK(flags(NearestRegion{Vector3d::Zero(), 100}) == "11111111");
}

TEST_CASE_FIXTURE(Fixture, "regions of one role are united") {
  const std::vector<Region> regions{NearestRegion{Vector3d::Zero(), 1}, NearestRegion{Vector3d::Ones(), 1}};
  CHECK(text(evaluate(regions, positions, box)) == "10000001");
}

TEST_CASE_FIXTURE(Fixture, "by default everything that is not fixed is touched and read") {
  const auto sets = select_nodes(scene_with(lower_half), positions, box);
  CHECK(text(sets.fixed.holds) == "11001100");
  CHECK(text(sets.touched.holds) == "00110011");
  CHECK(text(sets.read.holds) == "00110011");
}

TEST_CASE_FIXTURE(Fixture, "fixed nodes are neither touched nor read") {
  const auto sets =
      select_nodes(scene_with(lower_half + "[[touched]]\nabove = 1\naxis = \"z\"\n[[read]]\nbelow = 0\naxis = \"x\"\n"),
                   positions, box);
  CHECK(text(sets.touched.holds) == "00000011");
  CHECK(text(sets.read.holds) == "00100010");
}

TEST_CASE_FIXTURE(Fixture, "refused: fixed regions that hold no node") {
  const auto message = refusal(scene_with("[[fixed]]\nsphere = { center = [0.5, 0.5, 0.5], radius = 0.01 }\n"), *this);
  CHECK(message.find("fixed: the region holds none of the 8 nodes") != std::string::npos);
  CHECK(message.find("from (10, 20, 30) m to (12, 24, 31) m") != std::string::npos);
}

TEST_CASE_FIXTURE(Fixture, "refused: everything fixed") {
  const auto message = refusal(scene_with("[[fixed]]\nbelow = 1\naxis = \"y\"\n"), *this);
  CHECK(message.find("fixed: the regions hold all 8 nodes, so nothing can move") != std::string::npos);
}

TEST_CASE_FIXTURE(Fixture, "refused: touched and read regions that hold no node that can move, told together") {
  const std::string below = "below = 0.2\naxis = \"y\"\n";
  const auto message = refusal(scene_with(lower_half + "[[touched]]\n" + below + "[[read]]\n" + below), *this);
  CHECK(message.find("touched: the region holds none of the 4 nodes that can move (4 of 8 are fixed)") !=
        std::string::npos);
  CHECK(message.find("\nread: the region holds none of the 4 nodes") != std::string::npos);
}

TEST_CASE_FIXTURE(Fixture,
                  "nodes are counted by region, and a region that holds none of its own is refused by its place") {
  const std::string corner = "[[touched]]\nnear = [1, 1, 1]\n", all = "[[touched]]\nabove = 0\naxis = \"x\"\n";
  const auto sets = select_nodes(scene_with(lower_half + corner + all), positions, box);
  CHECK(sets.touched.of_region == std::vector<std::size_t>{1, 4});
  CHECK(sets.touched.count() == 4);
  CHECK(sets.fixed.of_region == std::vector<std::size_t>{4});
  CHECK(sets.read.of_region.empty());

  const std::string nowhere = "[[touched]]\nbox = [[0.4, 0.4, 0.4], [0.6, 0.6, 0.6]]\n";
  const auto message = refusal(scene_with(lower_half + corner + nowhere), *this);
  CHECK(message.find("touched 2 of 2: the region holds none of the 4 nodes that can move") != std::string::npos);
}

TEST_CASE("the example scene holds about a sixth of the teddy bear") {
  const char* data = std::getenv("GREENLOOP_DATA");
  REQUIRE_MESSAGE(data != nullptr, "GREENLOOP_DATA is not set; run the tests through ctest");
  const auto scene = read_scene(GREENLOOP_SOURCE "/offline/scene/examples/bear.toml");
  auto mesh = greenloop::read_surface(std::string(data) + "/meshes/" + scene.mesh.name);
  Eigen::AlignedBox3d box;
  for (const auto& vertex : mesh.vertices) {
    box.extend(vertex);
  }
  const double scale = scene.mesh.scale(box);
  std::for_each(mesh.vertices.begin(), mesh.vertices.end(), [&](Vector3d& vertex) { vertex *= scale; });
  box = {box.min() * scale, box.max() * scale};
  CHECK(box.sizes().maxCoeff() == doctest::Approx(0.3));
  const auto sets = select_nodes(scene, mesh.vertices, box);
  const auto fixed = static_cast<double>(sets.fixed.count());
  const double free_share = 1 - fixed / static_cast<double>(mesh.vertices.size());
  MESSAGE("free share of the bear's vertices: " << free_share);
  CHECK(free_share > 0.83);
  CHECK(free_share < 0.85);
}
