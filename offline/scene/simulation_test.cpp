// [simulate] and [[impulses]] of a scene, and what is wrong with them.

#include <Eigen/Core>
#include <string>
#include <variant>

#include "offline/scene/testing/scene_texts.hpp"

namespace greenloop::offline {
namespace {

using test::check_refused;
using test::smallest;
using test::with;

const std::string simulate =
    "[simulate]\ntime_step = \"10 ms\"\nrest = \"0.1 mm\"\nshortest = \"0.3 s\"\nlongest = \"1 s\"\norbits = 20\n";
const std::string left = "[[impulses]]\nname = \"left\"\nvelocity = \"50 cm/s\"\ndirection = [-2, 0, 0]\n";
const std::string right = "[[impulses]]\nname = \"right\"\nvelocity = \"0.5 m/s\"\ndirection = [1, 0, 0]\n";

std::string heavy(const std::string& rest) { return with("poisson", "density = \"1.2 g/cm3\"\npoisson") + rest; }

TEST_CASE("simulation: a scene without it has none; with it all is in SI, with defaults") {
  CHECK(!parse_scene(smallest, "s.toml").simulation);
  const auto scene = parse_scene(heavy(simulate + left), "s.toml");
  REQUIRE(scene.simulation);
  const Simulation& simulation = *scene.simulation;
  CHECK(simulation.time_step == 0.01);
  CHECK(simulation.rest == 1e-4);
  CHECK(simulation.corotational);
  CHECK(!simulation.coverage);
  CHECK(simulation.level == scene.remesh.levels);
  CHECK(simulation.longest_to_rest == 4);
  CHECK(simulation.orbits == 20);
  REQUIRE(simulation.impulses.size() == 1);
  CHECK(simulation.impulses[0].velocity() == Eigen::Vector3d(-0.5, 0, 0));
}

TEST_CASE("simulation: successions are those that the impulses say, all if they say none") {
  const auto table = [](const std::string& impulses) {
    return successions(*parse_scene(heavy(simulate + impulses), "s.toml").simulation);
  };
  CHECK(table(left + right) == std::vector<std::uint8_t>{1, 1, 1, 1, 1, 1});
  CHECK(table(left + "after = [\"rest\", \"right\"]\n" + right + "after = [\"left\"]\n") ==
        std::vector<std::uint8_t>{0, 1, 1, 0, 1, 0});
}

TEST_CASE("simulation: the canonical text says it, reads back and stays; columns do not follow from it") {
  const auto scene = parse_scene(
      heavy(simulate + "strain = \"linear\"\nmass_damping = \"2 1/s\"\nstiffness_damping = \"1 ms\"\n" + left +
            "after = [\"rest\"]\n" + right + "[trajectories]\nfile = \"t.h5\"\n" + "[accuracy]\ntruncation = 0.01\n"),
      "models/s.toml");
  CHECK(scene.simulation->trajectories == "models/t.h5");
  const auto text = canonical_text(scene);
  CHECK(text.find("mass_damping = \"2 1/s\"") != std::string::npos);
  CHECK(canonical_text(parse_scene(text, "s.toml")) == text);
  CHECK(body_text(scene) == body_text(parse_scene(heavy(""), "s.toml")));
}

const std::string sheet =
    "[surface]\nfile = \"cloth.off\"\nunit = \"m\"\n[[fixed]]\nabove = 0.9\naxis = \"y\"\n[sheet]\ndensity = \"200 "
    "g/m^2\"\n"
    "stretch = \"0.5 kN/m\"\nbend = \"1 mN m\"\nthickness = \"3 mm\"\n[trajectories]\nfile = \"cloth.h5\"\n";
const std::string turns = "[[impulses]]\nname = \"turns\"\nturning = -0.5\nlongest = \"2 s\"\n";
const std::string stops = "[[impulses]]\nname = \"stops\"\nafter = [\"turns\"]\n";
const std::string door = "[[rigid]]\nbox = [[0, -1, -0.04], [1, 0, 0]]\n";
const std::string post = "[[rigid]]\ncylinder = { from = [0, 0, 0], to = [0, 0, 1], radius = \"5 mm\" }\n";

TEST_CASE("sheets: no material, rigid shapes, impulses that last; the canonical text reads back") {
  const std::string goal = "held_out = 3\nreplay_goal = 0.05\n";
  const auto scene = parse_scene(sheet + simulate + goal + turns + stops + door + post, "s.toml");
  REQUIRE(scene.simulation);
  REQUIRE(scene.simulation->sheet);
  const Sheet& s = *scene.simulation->sheet;
  CHECK(s.density == 0.2);
  CHECK(s.stretch == 500);
  CHECK(s.bend == 1e-3);
  CHECK(s.rigid.size() == 2);
  CHECK(std::get<RigidCylinder>(s.rigid[1]).radius == 5e-3);
  CHECK(scene.simulation->replay_goal == 0.05);
  CHECK(scene.simulation->impulses[0].turning == -0.5);
  CHECK(scene.simulation->impulses[0].longest == 2);
  CHECK(scene.simulation->impulses[1].velocity().isZero());
  const auto text = canonical_text(scene);
  CHECK(canonical_text(parse_scene(text, "s.toml")) == text);
}

TEST_CASE("refused: sheets that lack something, rigid shapes that are none") {
  const std::string all = sheet + simulate + turns + stops;
  check_refused(sheet + simulate + "strain = \"linear\"\n" + turns, {"simulate.strain: is of elastic solids"});
  check_refused(all + "[[rigid]]\nbox = [[0, 0, 0], [1, 0, 1]]\n", {"rigid[0].box: expected two corners"});
  check_refused(all + "[[rigid]]\n", {"rigid[0]: expected either a box or a cylinder"});
  check_refused(all + "[[rigid]]\ncylinder = { from = [0, 0, 0], to = [0, 0, 0], radius = \"1 cm\" }\n",
                {"rigid[0].cylinder: expected two places"});
  check_refused(heavy(simulate + left + door), {"rigid: belong to a [sheet] section"});
  check_refused(heavy(simulate + turns), {"impulses[0].turning: goes with [sheet] only"});
  check_refused(all + "[[impulses]]\nname = \"x\"\nturning = 1\nvelocity = \"1 m/s\"\ndirection = [1, 0, 0]\n",
                {"impulses[2].turning: does not go with velocity"});
  check_refused(heavy(simulate + "replay_goal = 0.1\n" + left), {"simulate.replay_goal: needs held_out orbits"});
}

TEST_CASE("refused: simulations that lack something or contradict themselves") {
  check_refused(smallest + simulate + left, {"simulate: needs the body's mass"});
  check_refused(heavy(simulate), {"impulses: expected 1 to 64 tables"});
  check_refused(heavy(left), {"impulses: belong to a [simulate] section"});
  check_refused(heavy(simulate + "level = 4\n" + left), {"simulate.level: is finer than the finest level"});
  check_refused(heavy(simulate + "longest_to_rest = \"0.5 s\"\n" + left), {"simulate.longest_to_rest: is shorter"});
  check_refused(heavy(simulate + "strain = \"green\"\n" + left), {"simulate.strain", "neither \"corotational\""});
  check_refused(heavy(simulate + left + left), {"impulses[1].name", "another impulse's name already"});
  check_refused(heavy(simulate + left + "after = [\"rest\", \"up\"]\n"), {"follow the unknown \"up\""});
  check_refused(heavy(simulate + left + "after = [\"left\"]\n"), {"none may follow \"rest\""});
  check_refused(heavy(simulate + "[[impulses]]\nname = \"x\"\nvelocity = \"1 m\"\ndirection = [1, 0, 0]\n"),
                {"impulses[0].velocity", "\"m\" is a unit of length; speed units are m/s"});
}

}  // namespace
}  // namespace greenloop::offline
