#include "offline/scene/motion_scene.hpp"

#include <doctest/doctest.h>

#include <string>

#include "offline/scene/mesh_series.hpp"
#include "offline/scene/scene.hpp"

namespace greenloop::offline {
namespace {

template <class Parse>
void check_refused(const Parse& parse, const std::string& text, const std::string& part) {
  std::string message;
  try {
    (void)parse(text, "folder/scene.toml");
  } catch (const SceneError& error) {
    message = error.what();
  }
  CAPTURE(message);
  CHECK(message.find(part) != std::string::npos);
}

TEST_CASE("motion scenes: defaults, every key, and the same scene from its canonical text") {
  CHECK(!parse_motion_scene("[surface]\nfile = \"bear.off\"\n", "scene.toml"));
  const auto plain = parse_motion_scene("[trajectories]\nfile = \"x.h5\"\n", "folder/scene.toml");
  REQUIRE(plain);
  CHECK(plain->trajectories == "folder/x.h5");
  CHECK(plain->truncation == 0.01);
  CHECK(!plain->blend_rate);
  const auto full = parse_motion_scene(
      "[trajectories]\nfile = \"x.h5\"\n[accuracy]\ntruncation = 0.005\nquantisation = 0.02\n"
      "[reduction]\ndead_end = 0.3\nblend_rate = 12\nmemory = 64\n[budget]\nrate = \"1 kHz\"\n",
      "folder/scene.toml");
  REQUIRE(full);
  CHECK(full->truncation == 0.005);
  CHECK(full->quantisation == 0.02);
  CHECK(full->dead_end == 0.3);
  CHECK(full->blend_rate == 12);
  CHECK(full->memory == std::size_t{64} << 20U);
  CHECK(full->rate == 1000);
  CHECK(!full->appearance);
  const auto lit = parse_motion_scene(
      "[trajectories]\nfile = \"x.h5\"\n[appearance]\nreflectance = [0.8, 0.4, 1]\nerror = 0.2\nrank = 7\n"
      "states = 30\nrays = 64\nbounces = 0\n[[appearance.parts]]\nbox = [[0, 0, 0], [1, 0.1, 1]]\n"
      "reflectance = [0, 0.5, 0.1]\n",
      "scene.toml");
  REQUIRE(lit);
  REQUIRE(lit->appearance);
  CHECK(lit->appearance->reflectance == Eigen::Vector3d(0.8, 0.4, 1));
  CHECK(lit->appearance->error == 0.2);
  CHECK(lit->appearance->rank == 7);
  CHECK(lit->appearance->states == 30);
  CHECK(lit->appearance->rays == 64);
  CHECK(lit->appearance->bounces == 0);
  REQUIRE(lit->appearance->parts.size() == 1);
  CHECK(lit->appearance->parts[0].box.high == Eigen::Vector3d(1, 0.1, 1));
  CHECK(lit->appearance->parts[0].reflectance == Eigen::Vector3d(0, 0.5, 0.1));
  for (const auto& scene : {plain, full, lit}) {
    const std::string text = canonical_text(*scene);
    CHECK(canonical_text(*parse_motion_scene(text, "scene.toml")) == text);
  }
}

TEST_CASE("motion scenes: what is wrong is named") {
  const std::string head = "[trajectories]\nfile = \"x.h5\"\n";
  check_refused(parse_motion_scene, "[trajectories]\n", "trajectories.file: missing");
  check_refused(parse_motion_scene, head + "[masks]\nyoung = \"1 kPa\"\n", "masks: unknown key");
  check_refused(parse_motion_scene, head + "[accuracy]\ntruncation = 1\n", "accuracy.truncation: 1 is out of range");
  check_refused(parse_motion_scene, head + "[accuracy]\nrms = 0.1\n", "accuracy.rms: unknown key");
  check_refused(parse_motion_scene, head + "[reduction]\nmemory = 3\n", "reduction.memory: 3 is out of range");
  check_refused(parse_motion_scene, head + "[reduction]\nblend_rate = 0\n", "reduction.blend_rate: 0 is out of range");
  check_refused(parse_motion_scene, head + "[appearance]\nreflectance = [1, 2, 0]\n",
                "appearance.reflectance: expected red, green and blue");
  check_refused(parse_motion_scene, head + "[appearance]\nrank = 31\n", "appearance.rank: 31 is out of range");
  check_refused(parse_motion_scene, head + "[appearance]\nlight = 1\n", "appearance.light: unknown key");
  check_refused(parse_motion_scene, head + "[appearance]\nparts = 3\n", "appearance.parts: expected tables");
  check_refused(parse_motion_scene, head + "[[appearance.parts]]\nbox = [[0, 0, 0], [1, 1, 1]]\n",
                "appearance.parts[0].reflectance: missing");
  check_refused(parse_motion_scene, head + "[budget]\nrate = 60\n", "budget.rate: 60 has no unit");
}

const std::string series = R"(
rate = "100 Hz"
unit = "cm"
rest = "rest.obj"
[[impulse]]
name = "push"
initial = [1, 0, 0]
after = ["rest", "pull"]
[[impulse]]
name = "pull"
persistent = [0, 0.5]
[[orbit]]
impulse = "push"
frames = "push_%03d.obj"
first = 1
count = 20
[[orbit]]
impulse = "pull"
frames = "pull_%d.vtk"
count = 5
previous = [0, 6]
at_rest = true
held_out = true
)";

TEST_CASE("mesh series: impulses, successions and files of orbits") {
  const MeshSeries found = parse_mesh_series(series, "folder/series.toml");
  CHECK(found.time_step == doctest::Approx(0.01));
  CHECK(found.unit == 0.01);
  CHECK(found.rest == "folder/rest.obj");
  REQUIRE(found.impulses.size() == 2);
  CHECK(found.impulses[0].initial[0] == 1);
  CHECK(found.impulses[1].persistent[1] == 0.5);
  CHECK(found.successions == std::vector<std::uint8_t>{0, 1, 1, 1, 1, 1});
  REQUIRE(found.orbits.size() == 2);
  CHECK(found.orbits[0].file(0) == "folder/push_001.obj");
  CHECK(found.orbits[0].file(19) == "folder/push_020.obj");
  CHECK(found.orbits[1].file(4) == "folder/pull_4.vtk");
  CHECK(found.orbits[1].impulse == 1);
  CHECK(found.orbits[1].at_rest);
  CHECK(found.orbits[1].held_out);
  REQUIRE(found.orbits[1].previous);
  CHECK(found.orbits[1].previous->second == 6);
}

TEST_CASE("mesh series: what is wrong is named") {
  const auto changed = [](const std::string& from, const std::string& to) {
    std::string text = series;
    return text.replace(text.find(from), from.size(), to);
  };
  check_refused(parse_mesh_series, changed("rate = \"100 Hz\"", ""), "rate: missing");
  check_refused(parse_mesh_series, changed("100 Hz", "100 m"), "rate");
  check_refused(parse_mesh_series, changed("\"pull\"]", "\"pall\"]"), "did you mean \"pull\"?");
  check_refused(parse_mesh_series, changed("impulse = \"pull\"", "impulse = \"pall\""), "did you mean \"pull\"?");
  check_refused(parse_mesh_series, changed("push_%03d.obj", "push.obj"), "one place such as %04d");
  check_refused(parse_mesh_series, changed("push_%03d.obj", "push_%s.obj"), "one place such as %04d");
  check_refused(parse_mesh_series, changed("[0, 6]", "[1, 6]"), "an orbit before this one");
  check_refused(parse_mesh_series, changed("[0, 6]", "[0, 20]"), "an orbit before this one");
  check_refused(parse_mesh_series, changed("count = 5", "count = 1"), "orbit.count: 1 is out of range");
  check_refused(parse_mesh_series, changed("[1, 0, 0]", "[1, 0, 0, 0, 0]"), "at most four numbers");
}

}  // namespace
}  // namespace greenloop::offline
