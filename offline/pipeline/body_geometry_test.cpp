#include "offline/pipeline/body_geometry.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <numbers>
#include <stdexcept>
#include <string>

#include "formats/mesh/surface_io.hpp"
#include "formats/mesh/test_files.hpp"
#include "formats/mesh/volume_io.hpp"
#include "offline/pipeline/stage_records.hpp"
#include "offline/surface/area_and_volume.hpp"
#include "offline/surface/test_surfaces.hpp"
#include "offline/volume/testing/shapes.hpp"
#include "offline/volume/thickness.hpp"

namespace greenloop::offline {
namespace {

BodyGeometry geometry(const std::filesystem::path& folder, const std::string& of_surface,
                      const std::string& of_remesh = "") {
  const auto scene = parse_scene("[surface]\nfile = \"body.off\"\nunit = \"cm\"\n" + of_surface +
                                     "[remesh]\nlevels = 1\n" + of_remesh +
                                     "[material]\nyoung = \"20 kPa\"\npoisson = 0.4\n"
                                     "[[fixed]]\nbelow = 0.2\naxis = \"z\"\n",
                                 folder / "body.toml");
  ProgressBar quiet(true);
  return make_body_geometry(scene, quiet);
}

std::string refusal(const std::filesystem::path& folder, const std::string& of_surface) {
  try {
    static_cast<void>(geometry(folder, of_surface));
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST_CASE("a surface that does not enclose one solid is refused with the way out, which is one") {
  const auto folder = scratch_folder("body_geometry_test");
  write_surface(folder / "body.off", joined(cube(), cube({0.5, 0.5, 0.5})));
  const std::string refused = refusal(folder, "");
  CHECK(refused.find("several pieces: 2") != std::string::npos);
  CHECK(refused.find("set [surface] wrap = \"auto\"") != std::string::npos);

  const BodyGeometry body = geometry(folder, "wrap = \"0.05 cm\"\n");
  REQUIRE(body.report.wrap);
  CHECK(body.report.wrap->length == doctest::Approx(0.0005));
  CHECK(body.report.wrap->volume == doctest::Approx(1.875e-6).epsilon(1e-3));
  CHECK(body.report.wrap->to_original.greatest < 0.0005);
  CHECK(body.surface.positions.size() > 42);
  const auto record = geometry_record(body.report);
  CHECK(record["surface"]["wrap"]["length"] == body.report.wrap->length);
  CHECK(record["surface"]["wrap"]["volume_before"].get<double>() == doctest::Approx(2e-6));
  CHECK(record["surface"]["repairs"][0].get<std::string>().find("wrapped at 0.0005 m in ") == 0);
}

TEST_CASE("what a wrap refuses names the file and offers no other wrap") {
  const auto folder = scratch_folder("body_geometry_refusal_test");
  write_surface(folder / "body.off", joined(cube(), cube({2, 0, 0})));
  const std::string refused = refusal(folder, "wrap = \"auto\"\n");
  CHECK(refused.find("body.off: wrap: 2 separate pieces") != std::string::npos);
  CHECK(refused.find("set [surface] wrap") == std::string::npos);
}

TEST_CASE("a cavity that is asked for stays open in the tetrahedra, and its wall counts as thickness") {
  const auto folder = scratch_folder("body_geometry_cavity_test");
  const auto outer = testing::ellipsoid(3, {1, 1, 1}), inner = testing::ellipsoid(2, {0.6, 0.6, 0.6});
  write_surface(folder / "body.off", joined(finest_surface(outer), finest_surface(inner)));
  CHECK(refusal(folder, "").find("cavities = true") != std::string::npos);

  const BodyGeometry body = geometry(folder, "cavities = true\n");
  CHECK(body.report.cavities == 1);
  const double hollow = 4 * std::numbers::pi / 3 * 0.216e-6;
  CHECK(body.report.cavity_volume == doctest::Approx(hollow).epsilon(0.1));
  CHECK(enclosed_volume(body.walls) == doctest::Approx(-body.report.cavity_volume).epsilon(0.05));
  CHECK(geometry_record(body.report)["surface"]["cavities"]["count"] == 1);

  ProgressBar quiet(true);
  const FilledVolume filled = fill_with_tetrahedra(body, quiet);
  const double skin = enclosed_volume(finest_surface(body.surface));
  CHECK(filled.quality.volume == doctest::Approx(skin + enclosed_volume(body.walls)).epsilon(1e-12));
  const auto chords = inward_chords(body.surface, body.walls);
  const auto longest = std::max_element(chords.begin(), chords.end(),
                                        [](const Chord& a, const Chord& b) { return a.length < b.length; });
  CHECK(longest->length < 0.006);
  CHECK(cavity_walls(filled.volume.mesh).triangles.size() == body.walls.triangles.size());
}

TEST_CASE("tetrahedra keep the cavity that they have") {
  const auto folder = scratch_folder("body_geometry_hollow_test");
  write_volume(folder / "body.mesh", testing::shell(2, 3, 0.006, 0.01));
  const auto scene = parse_scene(
      "[volume]\nfile = \"body.mesh\"\nunit = \"m\"\n[remesh]\nlevels = 1\n[material]\nyoung = \"20 kPa\"\n"
      "poisson = 0.4\n[[fixed]]\nbelow = 0.2\naxis = \"z\"\n",
      folder / "body.toml");
  ProgressBar quiet(true);
  const BodyGeometry body = make_body_geometry(scene, quiet);
  REQUIRE(body.volume);
  CHECK(body.report.cavities == 1);
  CHECK(body.surface.positions.size() == 162);
  for (const auto& node : body.surface.positions) CHECK(node.norm() == doctest::Approx(0.01).epsilon(0.05));
  CHECK(cavity_walls(body.volume->mesh).triangles.size() == 320);
}

TEST_CASE("a wall that the levels do not resolve is refused with its place") {
  const auto folder = scratch_folder("body_geometry_wall_test");
  const auto outer = testing::ellipsoid(3, {1, 1, 1}), inner = testing::ellipsoid(3, {0.985, 0.985, 0.985});
  write_surface(folder / "body.off", joined(finest_surface(outer), finest_surface(inner)));
  const BodyGeometry body = geometry(folder, "cavities = true\n", "base_vertices = 12\n");
  ProgressBar quiet(true);
  std::string refused;
  try {
    static_cast<void>(fill_with_tetrahedra(body, quiet));
  } catch (const std::runtime_error& error) {
    refused = error.what();
  }
  CHECK(refused.find("a cavity's wall meets the surface or another wall at (") == 0);
  CHECK(refused.find("raise remesh.levels") != std::string::npos);
}

/// A cube with needles that stick out of it and cross each other.
TriangleMesh hedgehog() {
  TriangleMesh mesh = cube();
  for (int k = 0; k < 6; ++k) {
    const int axis = k / 2;
    const double side = k % 2 == 0 ? -1 : 1;
    const int first = static_cast<int>(mesh.vertices.size());
    for (int c = 0; c < 4; ++c) {
      Eigen::Vector3d place = Eigen::Vector3d::Constant(0.5);
      place[axis] += c == 3 ? 1.5 * side : 0;
      place[(axis + 1) % 3] += c == 1 ? 0.15 : 0;
      place[(axis + 2) % 3] += c == 2 ? 0.15 : 0;
      mesh.vertices.push_back(place);
    }
    for (const auto& [a, b, c] : {std::array{0, 2, 1}, std::array{0, 1, 3}, std::array{1, 2, 3}, std::array{2, 0, 3}}) {
      mesh.triangles.push_back({first + a, first + b, first + c});
    }
  }
  return mesh;
}

TEST_CASE("an automatic wrap that the levels do not resolve is rounded, and says why") {
  const auto folder = scratch_folder("body_geometry_rounding_test");
  write_surface(folder / "body.off", hedgehog());
  const BodyGeometry body = geometry(folder, "wrap = \"auto\"\n", "base_vertices = 12\n");
  REQUIRE(body.report.wrap);
  CHECK(body.report.wrap->rounding > 0);
  CHECK(body.report.repairs.back().find("rounded") != std::string::npos);
  CHECK(body.report.repairs.back().find("refused: ") != std::string::npos);
  CHECK(body.report.remesh.smallest_angle_degrees >= 8);
  CHECK(geometry_record(body.report)["surface"]["wrap"]["rounding"] == body.report.wrap->rounding);
}

TEST_CASE("a surface may be the boundary of tetrahedra; what a volume's boundary lacks names the way out") {
  const auto folder = scratch_folder("body_geometry_tetrahedra_test");
  const std::string two_that_touch =
      "MeshVersionFormatted 1\nDimension 3\nVertices\n7\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n-1 0 0 0\n0 -1 0 0\n"
      "0 0 -1 0\nTetrahedra\n2\n1 2 3 4 0\n1 5 7 6 0\nEnd\n";
  write_file(folder / "body.mesh", two_that_touch);
  const auto scene = [&](const std::string& kind, const std::string& keys) {
    return parse_scene("[" + kind + "]\nfile = \"body.mesh\"\nunit = \"cm\"\n" + keys +
                           "[remesh]\nlevels = 1\n[material]\nyoung = \"20 kPa\"\npoisson = 0.4\n"
                           "[[fixed]]\nbelow = 0.2\naxis = \"z\"\n",
                       folder / "body.toml");
  };
  ProgressBar quiet(true);
  std::string refused;
  try {
    static_cast<void>(make_body_geometry(scene("volume", ""), quiet));
  } catch (const std::runtime_error& error) {
    refused = error.what();
  }
  CHECK(refused.find("name the file in [surface] and set wrap = \"auto\"") != std::string::npos);
  const BodyGeometry body = make_body_geometry(scene("surface", "wrap = \"auto\"\npieces = \"largest\"\n"), quiet);
  CHECK(!body.volume);
  CHECK(body.report.repairs.front() == "the boundary of 2 tetrahedra taken");
}

}  // namespace
}  // namespace greenloop::offline
