#include "offline/pipeline/build_multigrid_model.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <vector>

#include "formats/mesh/surface_io.hpp"
#include "formats/testing/temporary_folder.hpp"
#include "formats/write/model_file.hpp"
#include "offline/simulate/examples/animal.hpp"
#include "runtime/multigrid.hpp"

namespace greenloop::offline {
namespace {

const std::string scene_text = R"(
[surface]
file = "animal.off"
size = "16 cm"
[remesh]
base_vertices = 130
levels = 1
[material]
young = "25 kPa"
poisson = 0.4
density = "1100 kg/m^3"
[[fixed]]
below = 0.06
axis = "y"
[multigrid]
level = 0
gravity = [0, -9.81, 0]
coarsest = 60
[[multigrid.parts]]
box = [[0, 0, 0], [1, 0.4, 1]]
young = "10 MPa"
)";

std::string changed(const std::string& from, const std::string& to) {
  std::string text = scene_text;
  return text.replace(text.find(from), from.size(), to);
}

TEST_CASE("a scene with [multigrid] becomes a model whose body sags under its weight between stiff legs") {
  const TemporaryFolder folder("build_multigrid_model");
  write_surface(folder.path() / "animal.off", examples::animal(1));
  const auto scene = folder.write("animal.toml", scene_text);
  const auto body = read_multigrid_scene(scene);
  REQUIRE(body);
  CHECK(body->time_step == doctest::Approx(1e-3));
  ProgressBar progress(true);
  const auto record = build_multigrid_model(scene, *body, folder.path() / "animal.gloop", progress);
  CHECK(record["kind"] == "multigrid");
  CHECK(record["tetrahedra"] > 300);
  CHECK(record["grids"] >= 2);
  const ModelFile file = open_model_file(folder.path() / "animal.gloop");
  const MultigridView& view = file.view.multigrid;
  CHECK(view.info->shown == examples::animal(1).vertices.size());
  const Model model = Model::open(file.bytes.span()).model;
  const Multigrid::Requirement need = Multigrid::required(model, {});
  AlignedBytes memory(need.bytes);
  Multigrid animal = Multigrid::create(model, {}, {memory.data(), memory.size()}).body;
  std::vector<Vec3> shown(view.info->shown);
  for (int i = 0; i < 500; ++i) {
    const auto report = animal.step({}, {need.least_work + 4 * need.cycle_work + need.shown_work}, {.shown = shown});
    REQUIRE(answered(report.status));
  }
  float highest = -1e9F, lowest = 1e9F, sag_of_back = 0, sag_of_feet = 0;
  for (std::size_t v = 0; v < shown.size(); ++v) {
    highest = std::max(highest, view.shape[3 * v + 1]);
    lowest = std::min(lowest, view.shape[3 * v + 1]);
  }
  for (std::size_t v = 0; v < shown.size(); ++v) {
    const float height = (view.shape[3 * v + 1] - lowest) / (highest - lowest);
    if (height > 0.7F) sag_of_back = std::min(sag_of_back, shown[v].y);
    if (height < 0.2F) sag_of_feet = std::max(sag_of_feet, std::abs(shown[v].y));
  }
  CHECK(sag_of_back < -1e-4F);
  CHECK(sag_of_feet < 0.1F * -sag_of_back);
}

TEST_CASE("what [multigrid] must not say") {
  const auto refused = [](const std::string& text, const char* what) {
    CHECK_THROWS_WITH_AS(static_cast<void>(parse_multigrid_scene(text, "own.toml")), doctest::Contains(what),
                         SceneError);
  };
  CHECK_FALSE(parse_multigrid_scene(scene_text.substr(0, scene_text.find("[multigrid]")), "own.toml"));
  refused(changed("level = 0\n", "strain = \"large\"\n"), "multigrid.strain");
  refused(changed("level = 0\n", "level = 2\n"), "multigrid.level");
  refused(changed("[0, -9.81, 0]", "[0, -9.81]"), "multigrid.gravity");
  refused(changed("coarsest = 60", "coarsest = 600"), "multigrid.coarsest");
  refused(changed("density = \"1100 kg/m^3\"\n", ""), "needs the body's mass");
  refused(changed("young = \"10 MPa\"", "young = 10"), "multigrid.parts[0].young");
  refused(changed("box = [[0, 0, 0], [1, 0.4, 1]]\n", ""), "multigrid.parts[0].box");
  refused(changed("level = 0\n", "colour = 1\n"), "colour");
}

}  // namespace
}  // namespace greenloop::offline
