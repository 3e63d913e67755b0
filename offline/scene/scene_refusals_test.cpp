// What a scene may not say, and how it is told.
#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "offline/scene/scene.hpp"
#include "offline/scene/testing/scene_texts.hpp"

using namespace greenloop::offline;
using namespace greenloop::offline::test;

TEST_CASE("all problems are reported together, in the order of the file") {
  const auto problems = problems_of("[material]\nyoung = 20000\npoison = 0.4\n[budget]\ncontacts = 0\n");
  REQUIRE(problems.size() == 6);
  CHECK(problems[0].starts_with("models/scene.toml: surface: missing"));
  CHECK(problems[1].starts_with("models/scene.toml: fixed: missing"));
  CHECK(problems[2].starts_with("models/scene.toml:1:1: material.poisson: missing"));
  CHECK(problems[3].starts_with("models/scene.toml:2:9: material.young: 20000 has no unit"));
  CHECK(problems[4].starts_with("models/scene.toml:3:1: material.poison: unknown key (did you mean \"poisson\"?)"));
  CHECK(problems[5].starts_with("models/scene.toml:5:12: budget.contacts: 0 is out of range"));
}

TEST_CASE("refused: text that is not TOML") { check_refused("[surface\nfile = 1\n", {"models/scene.toml:1:"}); }

TEST_CASE("refused: the same key twice") {
  check_refused(with("poisson = 0.4", "poisson = 0.4\npoisson = 0.3"), {"models/scene.toml:7:", "poisson"});
}

TEST_CASE("refused: an unknown table") {
  check_refused(smallest + "[acuracy]\nrms = 0.1\n", {":10:2: acuracy: unknown key", "did you mean \"accuracy\"?"});
}

TEST_CASE("refused: an unknown key") {
  check_refused(with("unit =", "units = 3\nunit ="), {":3:1: surface.units: unknown key", "did you mean \"unit\"?"});
}

TEST_CASE("refused: an unknown key like no valid one is answered by the valid ones") {
  check_refused(with("unit =", "zzzzzz = 3\nunit ="), {"surface.zzzzzz: unknown key; valid here: file, unit, size"});
}

TEST_CASE("refused: no surface") {
  check_refused(smallest.substr(smallest.find("[material]")), {"models/scene.toml: surface: missing"});
}

TEST_CASE("refused: a surface and a volume") {
  check_refused(smallest + "[volume]\nfile = \"a.msh\"\nunit = \"m\"\n",
                {"volume: the scene has [surface] and [volume]"});
}

TEST_CASE("refused: a surface without file") {
  check_refused(with("file = \"bear.off\"\n", ""), {":1:1: surface.file: missing; write for example file ="});
}

TEST_CASE("refused: an empty file name") { check_refused(with("bear.off", ""), {":2:8: surface.file: is empty"}); }

TEST_CASE("refused: a file that is not a string") {
  check_refused(with("\"bear.off\"", "[1]"), {":2:8: surface.file: is an array; expected a string"});
}

TEST_CASE("refused: a table that is a value") {
  check_refused("budget = 3\n" + smallest, {":1:10: budget: is a whole number; expected the table [budget]"});
}

TEST_CASE("refused: a surface without unit and size") {
  check_refused(with("unit = \"cm\"\n", ""),
                {":1:1: surface.unit: missing; say how long one unit", "size = \"30 cm\""});
}

TEST_CASE("refused: unit and size together") {
  check_refused(with("unit =", "size = \"3 cm\"\nunit ="), {":3:8: surface.size: unit and size contradict"});
}

TEST_CASE("refused: an unknown length unit") {
  check_refused(with("\"cm\"", "\"CM\""), {":3:8: surface.unit: unknown unit \"CM\" (did you mean \"cm\"?)"});
}

TEST_CASE("refused: a size of zero") {
  check_refused(with("unit = \"cm\"", "size = \"0 m\""), {"surface.size: \"0 m\" has to be greater than zero"});
}

TEST_CASE("refused: no material") {
  check_refused(with("[material]\nyoung = \"20 kPa\"\npoisson = 0.4\n", ""), {"models/scene.toml: material: missing"});
}

TEST_CASE("refused: Young's modulus without unit") {
  check_refused(with("\"20 kPa\"", "20000"),
                {"models/scene.toml:5:9: material.young: 20000 has no unit; write for example \"20 kPa\""});
}

TEST_CASE("refused: Young's modulus as a string without unit") {
  check_refused(with("20 kPa", "20"), {":5:9: material.young: \"20\" has no unit; write for example \"20 kPa\""});
}

TEST_CASE("refused: Young's modulus in a misspelt unit") {
  check_refused(with("20 kPa", "20 kpa"), {":5:9: material.young: unknown unit \"kpa\" (did you mean \"kPa\"?)"});
}

TEST_CASE("refused: Young's modulus as a length") {
  check_refused(with("20 kPa", "20 cm"), {"material.young: \"cm\" is a unit of length; pressure units are Pa, kPa"});
}

TEST_CASE("refused: a negative Young's modulus") {
  check_refused(with("20 kPa", "-20 kPa"), {"material.young: \"-20 kPa\" has to be greater than zero"});
}

TEST_CASE("refused: Young's modulus of true") {
  check_refused(with("\"20 kPa\"", "true"), {"material.young: is true or false; expected a string"});
}

TEST_CASE("refused: a material without Poisson's ratio") {
  check_refused(with("poisson = 0.4\n", ""), {":4:1: material.poisson: missing; write for example poisson = 0.4"});
}

TEST_CASE("refused: Poisson's ratio of an incompressible material") {
  check_refused(with("0.4", "0.5"),
                {":6:11: material.poisson: 0.5 is out of range", "greater than -1 and less than 0.5"});
}

TEST_CASE("refused: Poisson's ratio of -1") {
  check_refused(with("0.4", "-1"), {"material.poisson: -1 is out of range"});
}

TEST_CASE("refused: Poisson's ratio that is not a number") {
  check_refused(with("0.4", "nan"), {"material.poisson: nan is out of range"});
}

TEST_CASE("refused: Poisson's ratio as a string") {
  check_refused(with("0.4", "\"0.4\""), {"material.poisson: is a string; expected a number"});
}

TEST_CASE("refused: nothing fixed") {
  check_refused(smallest.substr(0, smallest.find("[[fixed]]")),
                {"models/scene.toml: fixed: missing; something has to hold"});
}

TEST_CASE("refused: fixed as a single table") {
  check_refused(with("[[fixed]]", "[fixed]"), {"fixed: is a table; expected one or more tables [[fixed]]"});
}

TEST_CASE("refused: an empty list of regions") {
  check_refused("touched = []\n" + smallest, {":1:11: touched: is an array; expected one or more tables [[touched]]"});
}

TEST_CASE("refused: a region without shape") {
  check_refused(with("below = 0.1\n", ""), {":7:1: fixed[0]: no shape; a region is exactly one of below, above, box"});
}

TEST_CASE("refused: a region of two shapes") {
  check_refused(with("below = 0.1", "below = 0.1\nabove = 0.9"), {"fixed[0]: several shapes (below, above)"});
}

TEST_CASE("refused: a misspelt key of a region") {
  check_refused(with("axis = \"y\"", "axis = \"y\"\nanis = 2"), {":10:1: fixed[0].anis: unknown key", "\"axis\"?"});
}

TEST_CASE("refused: a fraction above 1") {
  check_refused(with("0.1", "10"), {":8:9: fixed[0].below: 10 is out of range; it has to be at least 0 and at most 1"});
}

TEST_CASE("refused: a half space without axis") {
  check_refused(with("axis = \"y\"\n", ""), {"fixed[0].axis: missing; write for example axis = \"y\""});
}

TEST_CASE("refused: an axis that is none") {
  check_refused(with("\"y\"", "\"w\""), {":9:8: fixed[0].axis: \"w\" is no axis; expected \"x\", \"y\" or \"z\""});
}

TEST_CASE("refused: an axis for a box") {
  check_refused(with("below = 0.1", "box = [[0, 0, 0], [1, 1, 1]]"), {"fixed[0].axis: does not go with box"});
}

TEST_CASE("refused: a count for a half space") {
  check_refused(with("below = 0.1", "below = 0.1\ncount = 3"), {"fixed[0].count: does not go with below"});
}

TEST_CASE("refused: a box with one corner") {
  check_refused(smallest + "[[read]]\nbox = [[0, 0, 0]]\n", {":11:7: read[0].box: expected two corners"});
}

TEST_CASE("refused: a box with a corner of two numbers") {
  check_refused(smallest + "[[read]]\nbox = [[0, 0], [1, 1, 1]]\n", {"read[0].box: expected three fractions"});
}

TEST_CASE("refused: a box turned over") {
  check_refused(smallest + "[[read]]\nbox = [[0, 0.6, 0], [1, 0.5, 1]]\n", {"read[0].box: the first corner has to be"});
}

TEST_CASE("refused: a sphere without radius") {
  check_refused(smallest + "[[read]]\nsphere = { center = [0, 0, 0] }\n", {":11:10: read[0].sphere.radius: missing"});
}

TEST_CASE("refused: a sphere without center") {
  check_refused(smallest + "[[read]]\nsphere = { radius = 0.1 }\n", {"read[0].sphere.center: missing"});
}

TEST_CASE("refused: a sphere of radius zero") {
  check_refused(smallest + "[[read]]\nsphere = { center = [0, 0, 0], radius = 0 }\n",
                {"read[0].sphere.radius: 0 is out of range"});
}

TEST_CASE("refused: a sphere with a radius in kPa") {
  check_refused(smallest + "[[read]]\nsphere = { center = [0, 0, 0], radius = \"3 kPa\" }\n",
                {"read[0].sphere.radius: \"kPa\" is a unit of pressure; length units are"});
}

TEST_CASE("refused: a sphere that is no table") {
  check_refused(smallest + "[[read]]\nsphere = 3\n",
                {"read[0].sphere: is a whole number; expected the table [sphere]"});
}

TEST_CASE("refused: the nearest zero nodes") {
  check_refused(smallest + "[[read]]\nnear = [0, 0, 0]\ncount = 0\n", {":12:9: read[0].count: 0 is out of range"});
}

TEST_CASE("refused: a point outside the bounding box") {
  check_refused(smallest + "[[read]]\nnear = [0, 2, 0]\n", {":11:8: read[0].near: expected three fractions"});
}

TEST_CASE("refused: too few base vertices") {
  check_refused(smallest + "[remesh]\nbase_vertices = 3\n", {":11:17: remesh.base_vertices: 3 is out of range"});
}

TEST_CASE("refused: base vertices of a volume") {
  check_refused(with("[surface]", "[volume]") + "[remesh]\nbase_vertices = 42\n",
                {"remesh.base_vertices: does not go with [volume]"});
}

TEST_CASE("refused: a vertex map that is no flag, and one of a volume") {
  check_refused(with("unit =", "keep_vertex_map = 1\nunit ="),
                {":3:19: surface.keep_vertex_map: is a whole number; expected true or false"});
  check_refused(with("[surface]", "[volume]\nkeep_vertex_map = true"),
                {"volume.keep_vertex_map: does not go with [volume]"});
}

TEST_CASE("refused: elements that there are not") {
  check_refused(smallest + "\n[solve]\nelements = \"cubic\"\n",
                {"solve.elements: \"cubic\" are no elements; there are \"linear\", \"quadratic\""});
}

TEST_CASE("refused: a weld that is no length, and one of a volume") {
  check_refused(with("unit =", "weld = 0.1\nunit ="), {":3:8: surface.weld: 0.1 has no unit"});
  check_refused(with("unit =", "weld = \"automatic\"\nunit ="), {":3:8: surface.weld: "});
  check_refused(with("[surface]", "[volume]\nweld = \"1 mm\""), {"volume.weld: does not go with [volume]"});
}

TEST_CASE("refused: a wrap that is no length, pieces without one, a weld beside one, and one of a volume") {
  check_refused(with("unit =", "wrap = 2\nunit ="), {":3:8: surface.wrap: 2 has no unit"});
  check_refused(with("unit =", "wrap = \"automatic\"\nunit ="), {":3:8: surface.wrap: "});
  check_refused(with("unit =", "wrap = \"0 mm\"\nunit ="), {":3:8: surface.wrap: "});
  check_refused(with("unit =", "wrap = true\nunit ="), {":3:8: surface.wrap: "});
  check_refused(with("unit =", "wrap = \"auto\"\npieces = \"all\"\nunit ="),
                {":4:10: surface.pieces: \"all\" is neither \"one\""});
  check_refused(with("unit =", "pieces = \"largest\"\nunit ="), {"surface.pieces: chooses among the pieces of a wrap"});
  check_refused(with("unit =", "wrap = \"auto\"\ncavities = true\nunit ="),
                {"surface.cavities: does not go with wrap"});
  check_refused(with("unit =", "cavities = \"yes\"\nunit ="), {":3:12: surface.cavities: "});
  check_refused(with("unit =", "wrap = \"auto\"\nweld = \"1 mm\"\nunit ="), {"surface.weld: does not go with wrap"});
  check_refused(with("[surface]", "[volume]\nwrap = \"auto\""), {"volume.wrap: does not go with [volume]"});
}

TEST_CASE("refused: levels out of range") {
  check_refused(smallest + "[remesh]\nlevels = 8\n", {"remesh.levels: 8 is out of range; it has to be from 0 to 7"});
  check_refused(smallest + "[remesh]\nlevels = -1\n", {"remesh.levels: -1 is out of range"});
}

TEST_CASE("refused: levels with a fraction") {
  check_refused(smallest + "[remesh]\nlevels = 3.0\n",
                {"remesh.levels: is a number with a fraction; expected a whole"});
}

TEST_CASE("refused: a coarsest level finer than the finest") {
  check_refused(smallest + "[remesh]\nlevels = 2\n[constraints]\ncoarsest = 3\n",
                {":13:12: constraints.coarsest: 3 is finer than the finest level; remesh.levels is 2"});
}

TEST_CASE("refused: an accuracy of zero") {
  check_refused(smallest + "[accuracy]\nrms = 0\n", {"accuracy.rms: 0 is out of range"});
}

TEST_CASE("refused: a worst column of one") {
  check_refused(smallest + "[accuracy]\nworst_column = 1.0\n", {"accuracy.worst_column: 1 is out of range"});
}

TEST_CASE("refused: a wavelet that is none") {
  check_refused(smallest + "[compression]\nwavelet = \"haar\"\n",
                {"compression.wavelet: \"haar\" is no wavelet", "\"auto\"", "\"lifted butterfly\""});
  check_refused(smallest + "[compression]\nwavelt = \"linear\"\n", {"did you mean \"wavelet\"?"});
}

TEST_CASE("refused: a rate without unit") {
  check_refused(smallest + "[budget]\nrate = 1000\n", {"budget.rate: 1000 has no unit; write for example \"1 kHz\""});
}

TEST_CASE("refused: no work at all") {
  check_refused(smallest + "[budget]\nwork = 0\n", {"budget.work: 0 is out of range"});
}

TEST_CASE("refused: a share that is none, and a speed without one or beside work") {
  for (const std::string bad : {"0", "-0.1", "1.01", "inf"}) {
    check_refused(smallest + "[budget]\nshare = " + bad + "\n", {"budget.share: ", " is out of range"});
  }
  check_refused(smallest + "[budget]\nshare = 0.5\nunits_per_us = 0\n",
                {"budget.units_per_us: 0 is out of range; it has to be greater than 0"});
  check_refused(smallest + "[budget]\nunits_per_us = 500\n", {":11:16: budget.units_per_us: ", "share = 0.4"});
  check_refused(smallest + "[budget]\nshare = 0.5\nwork = 9\nunits_per_us = 500\n",
                {"budget.units_per_us: work and units_per_us contradict each other"});
  check_refused(smallest + "[budget]\nrate = \"0.001 Hz\"\nshare = 1\n",
                {"budget.share: of this period is more than 10^12 work units"});
}

TEST_CASE("refused: contacts out of range") {
  check_refused(smallest + "[budget]\ncontacts = 0\n", {"budget.contacts: 0 is out of range"});
  check_refused(smallest + "[budget]\ncontacts = 4097\n", {"budget.contacts: 4097 is out of range"});
}

TEST_CASE("refused: a store without file") {
  check_refused(smallest + "[store]\n", {":10:1: store.file: missing; write for example file = \"bear.h5\""});
}

TEST_CASE("refused: a scene file that is not there") {
  CHECK_THROWS_WITH_AS(static_cast<void>(read_scene("/")), doctest::Contains("/: no file"), SceneError);
  CHECK_THROWS_WITH_AS(static_cast<void>(read_scene("/dev/zero")), doctest::Contains("/dev/zero: no file"), SceneError);
  const auto long_one = std::filesystem::temp_directory_path() / "greenloop_long_scene.toml";
  std::ofstream(long_one) << smallest << std::string(largest_scene_file, '#');
  CHECK_THROWS_WITH_AS(static_cast<void>(read_scene(long_one)), doctest::Contains("a scene has at most 1048576"),
                       SceneError);
  std::filesystem::remove(long_one);
  CHECK_THROWS_WITH_AS(static_cast<void>(read_scene("no/such/scene.toml")), "no/such/scene.toml: cannot be read",
                       SceneError);
}

TEST_CASE("refused: a value without its quotes, with what to write") {
  const auto message = [](const std::string& text) {
    try {
      static_cast<void>(parse_scene(text, "s.toml"));
    } catch (const SceneError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  CHECK(message("[surface]\nfile = pad.off\nunit = \"mm\"\n") ==
        "s.toml:2:8: Error while parsing value: could not determine value type; words, and numbers with a unit, stand "
        "in quotes: file = \"pad.off\"");
  CHECK(message("[material]\nyoung = 20 kPa  # soft\r\n").ends_with("stand in quotes: young = \"20 kPa\""));
  const std::string other = message("[surface]\nfile = \"pad.off\nunit = 3\n");
  CHECK(other.starts_with("s.toml:2:"));
  CHECK(other.find("stand in quotes") == std::string::npos);
}

TEST_CASE("refused: a size for a mesh without extent") {
  const auto scene = parse_scene(with("unit = \"cm\"", "size = \"2 m\""), "s.toml");
  CHECK_THROWS_AS(static_cast<void>(scene.mesh.scale(Eigen::AlignedBox3d())), SceneError);
}
