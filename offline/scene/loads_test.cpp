// [[loads]] of a scene: gravity and pressures, and what is wrong with them.

#include <Eigen/Core>
#include <string>

#include "offline/scene/testing/scene_texts.hpp"

namespace greenloop::offline {
namespace {

using test::check_refused;
using test::problems_of;
using test::smallest;
using test::with;

const std::string gravity = "[[loads]]\ngravity = true\n";
const std::string palm = "[[loads]]\nname = \"palm\"\nabove = 0.9\naxis = \"y\"\n";

std::string dense(const std::string& loads) { return with("poisson", "density = \"1.2 g/cm3\"\npoisson") + loads; }

TEST_CASE("loads: a scene without them has none; gravity and pressures are read, in SI") {
  const Scene none = parse_scene(smallest, "s.toml");
  CHECK(!none.gravity);
  CHECK(none.pressures.empty());
  CHECK(!none.density);
  const Scene scene = parse_scene(
      dense(gravity + palm + "[[loads]]\nname = \"heel\"\nnear = [0, 0, 0]\ncount = 9\ndirection = [0, -3, 4]\n"),
      "s.toml");
  CHECK(scene.gravity);
  CHECK(*scene.density == 1200);
  REQUIRE(scene.pressures.size() == 2);
  CHECK(scene.pressures[0].name == "palm");
  CHECK(!scene.pressures[0].direction);
  CHECK(std::get<HalfSpace>(scene.pressures[0].region).fraction == 0.9);
  CHECK(*scene.pressures[1].direction == Eigen::Vector3d(0, -3, 4));
  CHECK(!parse_scene(dense("[[loads]]\ngravity = false\n"), "s.toml").gravity);
}

TEST_CASE("loads: the canonical text says them, reads back and stays; columns do not follow from them") {
  const Scene scene = parse_scene(dense(palm + gravity +
                                        "[[loads]]\nname = \"a\\\"b\"\nbelow = 1\naxis = \"x\"\n"
                                        "direction = [0.1, 0, -1e-9]\n"),
                                  "s.toml");
  const std::string text = canonical_text(scene);
  CHECK(text.find("density = \"1200 kg/m^3\"") != std::string::npos);
  const Scene again = parse_scene(text, "s.toml");
  CHECK(canonical_text(again) == text);
  CHECK(again.gravity);
  REQUIRE(again.pressures.size() == 2);
  CHECK(again.pressures[1].name == "a\"b");
  CHECK(body_text(scene) == body_text(parse_scene(smallest, "s.toml")));
}

TEST_CASE("loads: a mask is read with its sphere, written again, and refused with another shape") {
  const std::string finger = "[[loads]]\nname = \"finger\"\nmask = true\n";
  const std::string sphere = "sphere = { center = [0.5, 1, 0.5], radius = \"1 cm\" }\n";
  const Scene scene = parse_scene(smallest + finger + sphere + palm, "s.toml");
  REQUIRE(scene.pressures.size() == 2);
  CHECK(scene.pressures[0].mask);
  CHECK(!scene.pressures[1].mask);
  const Scene again = parse_scene(canonical_text(scene), "s.toml");
  CHECK(again.pressures[0].mask);
  CHECK(std::get<SphereRegion>(again.pressures[0].region).radius == 0.01);
  check_refused(smallest + finger + "above = 0.9\naxis = \"y\"\n", {"loads[0].mask: goes with a sphere"});
  check_refused(smallest + "[[loads]]\nname = \"a\"\nmask = 2\n" + sphere, {"loads[0].mask", "true or false"});
}

TEST_CASE("loads: gravity without a density, beside other keys, or of another type is refused by name") {
  check_refused(smallest + gravity,
                {"loads[0].gravity: needs the body's mass", "[material] density = \"1000 kg/m^3\""});
  check_refused(dense("[[loads]]\ngravity = true\nname = \"g\"\n"),
                {"loads[0].gravity", "a table [[loads]] of its own"});
  check_refused(dense("[[loads]]\ngravity = 9.81\n"), {"loads[0].gravity", "expected true or false"});
  check_refused(dense("[loads]\ngravity = true\n"), {"loads: is a table", "[[loads]] gravity = true"});
  check_refused(with("poisson", "density = 1000\npoisson"), {"material.density: 1000 has no unit", "1000 kg/m^3"});
  check_refused(with("poisson", "density = \"1000 kPa\"\npoisson"),
                {"material.density", "is a unit of pressure", "kg/m3"});
  check_refused(with("poisson", "density = \"0 kg/m3\"\npoisson"), {"material.density", "greater than zero"});
}

TEST_CASE("loads: names, directions and shapes of pressures are checked") {
  const std::string place = "above = 0.9\naxis = \"y\"\n", load = "[[loads]]\n";
  check_refused(smallest + load + place, {"loads[0].name: missing", "palm"});
  check_refused(smallest + load + "name = \"" + std::string(48, 'a') + "\"\n" + place, {"loads[0].name", "at most 47"});
  check_refused(smallest + load + "name = \"\u00e4\"\n" + place, {"loads[0].name", "printable ASCII"});
  check_refused(smallest + palm + palm, {"loads[1].name: \"palm\" is another load's name"});
  check_refused(smallest + load + "name = \"a\"\n", {"loads[0]: no shape"});
  for (const char* wrong : {"[0, 0, 0]", "[1, 2]", "\"up\"", "[1, 2, nan]", "3"}) {
    CAPTURE(wrong);
    check_refused(smallest + palm + "direction = " + wrong + "\n",
                  {"loads[0].direction", "\"normal\" or three finite"});
  }
  std::string many;
  for (int i = 0; i < 62; ++i) many += load + "name = \"" + std::to_string(i) + "\"\n" + place;
  check_refused(smallest + many, {"loads[61]: there are at most 61 pressures"});
}

TEST_CASE("loads: a pressure on nothing, or on nodes that nothing is stored of, is refused before it is solved") {
  std::vector<Eigen::Vector3d> positions;
  for (int i = 0; i < 40; ++i) positions.emplace_back(i % 4, i / 4, i % 3);
  const Eigen::AlignedBox3d box(Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(3, 9, 2));
  const auto problem_of = [&](const std::string& text) -> std::string {
    try {
      (void)select_nodes(parse_scene(text, "s.toml"), positions, box);
    } catch (const SceneError& error) {
      return error.what();
    }
    return "";
  };
  CHECK(problem_of(smallest + palm).empty());
  const std::string low = "[[loads]]\nname = \"sole\"\nbelow = 0.05\naxis = \"y\"\n";
  CHECK(problem_of(smallest + low).find("loads: \"sole\": the region holds no triangle that can move") == 0);
  const std::string half = "[[touched]]\nabove = 0.5\naxis = \"y\"\n[[read]]\nabove = 0.7\naxis = \"y\"\n";
  const std::string middle = "[[loads]]\nname = \"waist\"\nabove = 0.3\naxis = \"y\"\n";
  const std::string finger = "mask = true\nsphere = { center = [0, 0, 0], radius = 0.05 }\n";
  CHECK(problem_of(smallest + "[[loads]]\nname = \"toe\"\n" + finger).find("loads: \"toe\": the region holds no") == 0);
  CHECK(problem_of(smallest + half + middle)
            .find("loads: \"waist\": the region holds 8 nodes that are neither touched nor read, of 28") == 0);
}

}  // namespace
}  // namespace greenloop::offline
