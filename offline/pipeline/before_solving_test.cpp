#include "offline/pipeline/before_solving.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

#include "formats/mesh/surface_io.hpp"
#include "formats/mesh/volume_io.hpp"
#include "formats/testing/temporary_folder.hpp"
#include "offline/pipeline/body_sizes.hpp"
#include "offline/volume/testing/shapes.hpp"

namespace greenloop::offline {
namespace {

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

// A body in a folder of its own, built as often as is asked for.
class Build {
 public:
  [[nodiscard]] std::filesystem::path file(const std::string& name) const { return folder_.path() / name; }

  // what the build says if it fails
  std::string fails(const std::string& mesh, const std::string& rest) {
    std::ofstream(file("body.toml")) << mesh << "size = \"10 cm\"\n[material]\nyoung = \"20 kPa\"\npoisson = 0.4\n"
                                     << "[[fixed]]\nbelow = 0.1\naxis = \"z\"\n[compression]\nwavelet = \"linear\"\n"
                                     << rest;
    progress_ = ProgressBar(true);
    try {
      record_ = build_model_file({.scene = file("body.toml"), .model = file("body.gloop"), .store = file("body.h5")},
                                 progress_)
                    .record;
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return {};
  }

  [[nodiscard]] const nlohmann::json& record() const { return record_; }
  [[nodiscard]] bool warned(const std::string& of) const {
    return std::any_of(progress_.warnings().begin(), progress_.warnings().end(),
                       [&](const std::string& warning) { return warning.starts_with(of); });
  }

 private:
  TemporaryFolder folder_{"before_solving_test"};
  ProgressBar progress_{true};
  nlohmann::json record_;
};

TEST_CASE("sizes: counts, the store's bytes, and estimates that grow with them") {
  std::vector<std::uint32_t> flags(1000, layout::node_fixed);
  std::fill_n(flags.begin(), 500, layout::node_domain | layout::node_touchable);
  std::fill_n(flags.begin() + 500, 100, 0U);
  const BodySizes sizes = estimate_sizes(flags, 0);
  CHECK(sizes.nodes == 1000);
  CHECK(sizes.moving == 600);
  CHECK(sizes.columns == 500);
  CHECK(sizes.store_bytes == 72.0 * 500 * 500);
  CHECK(sizes.factor_bytes < estimate_sizes(flags, 2000).factor_bytes);
  CHECK_FALSE(sizes.large());
}

TEST_CASE("a large body is refused with its sizes and the levels that would do") {
  SemiRegularMesh mesh;
  mesh.vertex_end = {9, 600, 2500, 10000};
  const std::vector<std::uint32_t> flags(10000, layout::node_domain);
  const BodySizes sizes = estimate_sizes(flags, 0);
  REQUIRE(sizes.store_bytes == 7.2e9);
  try {
    require_moderate(sizes, "big.toml", greenloop::Elements::linear, mesh, flags);
    FAIL("accepted");
  } catch (const SceneError& error) {
    const std::string message = error.what();
    CHECK(contains(message, "big.toml: remesh.levels: 10000 columns make a store of 7.2 GB"));
    CHECK(contains(message, "--allow-large; remesh.levels = 2 would do"));
  }
  CHECK_NOTHROW(require_moderate(estimate_sizes(std::span(flags).first(2500), 0), "big.toml",
                                 greenloop::Elements::linear, mesh, flags));
}

TEST_CASE("tetrahedra that cannot carry the nodes are refused before there is a store, with the levels that they can") {
  Build build;
  write_volume(build.file("box.mesh"), testing::box({3, 3, 3}, {1, 1, 1}));
  const std::string mesh = "[volume]\nfile = \"box.mesh\"\n", levels = "[remesh]\nlevels = ";
  const std::string message = build.fails(mesh, levels + "3\n");
  CHECK(contains(message, "box.mesh: "));
  CHECK_FALSE(std::filesystem::exists(build.file("body.h5")));
  const std::string before = "remesh.levels = ";
  REQUIRE(contains(message, before));
  const char level = message[message.find(before) + before.size()];
  CHECK(build.fails(mesh, levels + level + "\n").empty());
}

TEST_CASE("a thin part is warned of by name, a thick one is not") {
  Build build;
  const std::string mesh = "[surface]\nfile = \"body.off\"\n", levels = "[remesh]\nbase_vertices = 12\nlevels = 2\n";
  const auto write = [&](const Eigen::Vector3d& axes) {
    const SemiRegularMesh body = testing::ellipsoid(2, axes);
    write_surface(build.file("body.off"), {body.positions, triangles_of_level(body, 2)});
  };
  write({1, 1, 1});
  REQUIRE(build.fails(mesh, levels).empty());
  CHECK_FALSE(build.warned("thin part: "));
  CHECK(build.record()["thinnest_part"]["tetrahedra_across"] >= 3);
  CHECK(build.record()["sizes"]["nodes"] == 162);
  std::filesystem::remove(build.file("body.h5"));
  write({1, 1, 0.2});
  REQUIRE(build.fails(mesh, levels).empty());
  CHECK(build.warned("thin part: "));
  CHECK(build.record()["thinnest_part"]["tetrahedra_across"] < 3);
  CHECK(build.record()["warnings"].dump().find("remesh.levels = ") != std::string::npos);
}

TEST_CASE("what was asked stands beside what is reached, with one verdict") {
  Build build;
  const SemiRegularMesh ball = testing::ellipsoid(1, {1, 1, 1});
  write_surface(build.file("body.off"), {ball.positions, triangles_of_level(ball, 1)});
  const std::string mesh = "[surface]\nfile = \"body.off\"\n", levels = "[remesh]\nbase_vertices = 12\nlevels = 1\n";
  REQUIRE(build.fails(mesh, levels).empty());
  CHECK(build.record()["verdict"] == "HELD");
  CHECK(build.record()["quality"]["mesh_error"]["asked"].is_null());
  CHECK(contains(build.record()["quality"]["sentence"], "; warning: the tetrahedra make forces of pressed patches"));
  CHECK(build.warned("mesh error: "));
  REQUIRE(build.fails(mesh, levels + "[accuracy]\nmesh_error = 0.05\n").empty());
  const auto strict = build.record();
  CHECK(strict["verdict"] == "VIOLATED");
  CHECK(strict["quality"]["mesh_error"]["asked"] == 0.05);
  CHECK(strict["quality"]["mesh_error"]["reached"] == strict["mesh_error"]["force"]);
  CHECK(strict["quality"]["compression_error"]["rms"]["reached"] <= 0.02);
  CHECK(contains(strict["quality"]["sentence"], "the mesh error is "));
  CHECK(strict["quality"]["arena_bytes"] > 0);
  CHECK(strict["quality"]["step_us"]["asked"] == 1000);
  REQUIRE(build.fails(mesh, levels + "[accuracy]\nmesh_error = 9\n").empty());
  CHECK(build.record()["verdict"] == "HELD");
}

}  // namespace
}  // namespace greenloop::offline
