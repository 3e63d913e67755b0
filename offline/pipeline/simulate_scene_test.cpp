#include "offline/pipeline/simulate_scene.hpp"

#include <doctest/doctest.h>

#include <array>
#include <optional>
#include <string>

#include "formats/mesh/surface_io.hpp"
#include "formats/testing/temporary_folder.hpp"
#include "formats/trajectory/trajectory_file.hpp"
#include "offline/pipeline/build_motion_model.hpp"
#include "offline/scene/motion_scene.hpp"
#include "offline/simulate/examples/animal.hpp"
#include "offline/simulate/examples/sheets.hpp"

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
[simulate]
time_step = "20 ms"
level = 0
sampling = "coverage"
stiffness_damping = "5 ms"
mass_damping = "4 1/s"
rest = "1 mm"
orbits = 4
held_out = 1
shortest = "0.1 s"
longest = "0.2 s"
to_rest = 0.5
[[impulses]]
name = "braking"
velocity = "0.2 m/s"
direction = [-1, 0, 0]
[[impulses]]
name = "bump"
velocity = "0.2 m/s"
direction = [0, 1, 0]
[trajectories]
file = "animal.h5"
[appearance]
rays = 36
states = 8
)";

TEST_CASE(
    "from a scene to a model: the finest level is shown, its feet stay, it goes on and is finished, and replays") {
  const TemporaryFolder folder("simulate_scene");
  write_surface(folder.path() / "animal.off", examples::animal(1));
  const SimulateRequest request{folder.write("animal.toml", scene_text), {}, false};
  ProgressBar progress(true);
  const auto record = simulate_scene(request, progress);
  CHECK(record["tetrahedra"] > 300);
  CHECK(record["tetrahedra"] < 2000);
  CHECK(record["orbits"] == 5);
  auto file = std::optional(TrajectoryFile::open(folder.path() / "animal.h5"));
  const auto& scene = file->scene();
  CHECK(scene.vertices() == examples::animal(1).vertices.size());
  CHECK(scene.triangles.size() == 3 * examples::animal(1).triangles.size());
  CHECK(scene.impulses[0].initial[0] == doctest::Approx(-0.2));
  CHECK(scene.orbits[0].held_out);
  std::vector<float> frame(scene.rest.size());
  file->read_frames(scene.orbits[1].first_frame + 2, 1, frame);
  double highest = 0, lowest = 1, moved_low = 0, moved_high = 0;
  for (std::size_t v = 0; v < scene.vertices(); ++v) {
    highest = std::max<double>(highest, scene.rest[3 * v + 1]);
    lowest = std::min<double>(lowest, scene.rest[3 * v + 1]);
  }
  for (std::size_t v = 0; v < scene.vertices(); ++v) {
    const double height = (scene.rest[3 * v + 1] - lowest) / (highest - lowest);
    const double moved =
        std::abs(frame[3 * v] - scene.rest[3 * v]) + std::abs(frame[3 * v + 1] - scene.rest[3 * v + 1]);
    if (height < 0.02) moved_low = std::max(moved_low, moved);
    if (height > 0.9) moved_high = std::max(moved_high, moved);
  }
  // what is shown hangs on tetrahedra, and of some at the feet not all corners are fixed
  CHECK(moved_low < 0.1 * moved_high);
  CHECK(moved_high > 1e-3);
  file.reset();
  // once more: nothing is left to do
  CHECK(simulate_scene(request, progress) == record);
  const auto motion = read_motion_scene(request.scene);
  REQUIRE(motion);
  const auto model = build_motion_model(request.scene, *motion, folder.path() / "animal.gloop", progress);
  CHECK(model["kind"] == "impulse_response");
  CHECK(model["truncation_error"] < 0.03);
  CHECK(model["replay_error"]["orbits"] == 1);
  CHECK(model["replay_error"]["median"] < 0.5);
  REQUIRE(model["appearance"]["sampling"].size() == 1);
  CHECK(model["appearance"]["sampling"][0]["error_of_transfer"] < 0.05);
  CHECK(model["appearance"]["singular_values"].size() == 8);
  const SimulateRequest other{
      folder.write("other.toml", std::string(scene_text).replace(scene_text.find("25 kPa"), 6, "26 kPa")), {}, false};
  CHECK_THROWS_WITH(simulate_scene(other, progress), doctest::Contains("trajectories of another scene"));
}

std::string sheet_scene(const std::string& name, const std::string& sheet_and_impulses) {
  return "[surface]\nfile = \"" + name + ".off\"\nunit = \"m\"\n[trajectories]\nfile = \"" + name + ".h5\"\n" + R"(
[accuracy]
truncation = 0.02
[simulate]
time_step = "20 ms"
rest = "1 cm"
orbits = 12
held_out = 2
shortest = "0.2 s"
longest = "0.5 s"
to_rest = 0.2
)" + sheet_and_impulses;
}

const std::string cloth_text = sheet_scene("cloth", R"(
[[fixed]]
above = 0.99
axis = "y"
[sheet]
density = "0.2 kg/m^2"
stretch = "500 N/m"
bend = "1 mN m"
thickness = "3 mm"
damping = "1 1/s"
air = "2 1/s"
settling = "1 s"
substeps = 12
[[rigid]]
box = [[0, -1.2, -0.04], [1, 0, 0]]
[[impulses]]
name = "opening"
turning = 0.8
longest = "0.3 s"
after = ["rest", "stop"]
[[impulses]]
name = "stop"
after = ["opening"]
)");

const std::string plant_text = sheet_scene("plant", R"(
[[fixed]]
below = 0.08
axis = "y"
[sheet]
density = "0.4 kg/m^2"
stretch = "2 kN/m"
bend = "10 mN m"
thickness = "4 mm"
damping = "3 1/s"
settling = "1 s"
substeps = 30
finer = 1
[[rigid]]
cylinder = { from = [0, -0.13, 0], to = [0, -0.012, 0], radius = "8 cm" }
[[impulses]]
name = "left"
velocity = "1 m/s"
direction = [-1, 0, 0]
after = ["rest", "stop"]
[[impulses]]
name = "stop"
after = ["left"]
)");

TEST_CASE(
    "small sheets, from a scene to a model: impulses last and follow each other as they may, penetrations are "
    "counted") {
  for (const bool is_cloth : {true, false}) {
    const TemporaryFolder folder("simulate_sheets");
    const std::string name = is_cloth ? "cloth" : "plant";
    write_surface(folder.path() / (name + ".off"), is_cloth ? examples::cloth(9) : examples::plant(6));
    const SimulateRequest request{folder.write(name + ".toml", is_cloth ? cloth_text : plant_text), {}, false};
    ProgressBar progress(true);
    const auto record = simulate_scene(request, progress);
    CHECK(record["orbits"] == 14);
    CHECK(record.contains("replay_estimate"));
    {
      const auto file = TrajectoryFile::open(folder.path() / (name + ".h5"));
      CHECK(file.scene().impulses[0].persistent[is_cloth ? 3 : 0] == doctest::Approx(is_cloth ? 0.8 : -1));
      CHECK(file.scene().impulses[1].persistent == std::array<double, 4>{});
      for (const auto& orbit : file.scene().orbits) {
        CHECK((!is_cloth || orbit.impulse == 1 || orbit.frames <= 16));
        CHECK((orbit.previous_frame >= 0 || orbit.impulse == 0));
      }
    }
    const auto motion = read_motion_scene(request.scene);
    REQUIRE(motion);
    const auto model = build_motion_model(request.scene, *motion, folder.path() / (name + ".gloop"), progress);
    CHECK(model["truncation_error"] < 0.05);
    CHECK(model["replay_error"]["orbits"] == 2);
    CHECK(model["replay_error"]["median"] < 0.8);
    const auto& counts = model["penetrations"];
    CHECK(counts["simulated"]["frames"] > 2);
    CHECK(counts["simulated"]["frames"] == counts["replayed"]["frames"]);
    CHECK(counts["simulated"]["inside_frames"] == 0);
    CHECK(counts["simulated"]["crossing_frames"] == 0);
  }
}

}  // namespace
}  // namespace greenloop::offline
