#include "offline/scene/scene.hpp"

#include <doctest/doctest.h>

#include <fstream>
#include <initializer_list>
#include <iterator>
#include <string>
#include <string_view>

#include "offline/scene/fingerprint.hpp"

using namespace greenloop::offline;

namespace {

const std::string smallest =
    "[surface]\nfile = \"bear.off\"\nunit = \"cm\"\n"  // lines 1 to 3
    "[material]\nyoung = \"20 kPa\"\npoisson = 0.4\n"  // lines 4 to 6
    "[[fixed]]\nbelow = 0.1\naxis = \"y\"\n";          // lines 7 to 9

std::string with(std::string_view from, std::string_view to) {
  const auto at = smallest.find(from);
  REQUIRE(at != std::string::npos);
  return std::string(smallest).replace(at, from.size(), to);
}

std::vector<std::string> problems_of(const std::string& text) {
  try {
    static_cast<void>(parse_scene(text, "models/scene.toml"));
  } catch (const SceneError& error) {
    return error.problems();
  }
  return {};
}

/// Exactly one problem, with all of these pieces in its message.
void check_refused(const std::string& text, std::initializer_list<std::string_view> pieces) {
  const auto problems = problems_of(text);
  REQUIRE_MESSAGE(problems.size() == 1, text);
  CAPTURE(problems[0]);
  for (const auto piece : pieces) {
    CAPTURE(piece);
    CHECK(problems[0].find(piece) != std::string::npos);
  }
}

}  // namespace

TEST_CASE("the smallest scene gets the documented defaults") {
  const auto scene = parse_scene(smallest, "models/scene.toml");
  CHECK_FALSE(scene.mesh.tetrahedra);
  CHECK(scene.mesh.name == "bear.off");
  CHECK(scene.mesh.path == "models/bear.off");
  CHECK(scene.mesh.unit == 0.01);
  CHECK_FALSE(scene.mesh.size);
  CHECK(scene.material.young == 20000);
  CHECK(scene.material.poisson == 0.4);
  CHECK(scene.remesh.base_vertices == 42);
  CHECK(scene.remesh.levels == 3);
  REQUIRE(scene.fixed.size() == 1);
  CHECK(std::get<HalfSpace>(scene.fixed[0]).axis == 1);
  CHECK(scene.touched.empty());
  CHECK(scene.read.empty());
  CHECK(scene.coarsest_constraints == 0);
  CHECK(scene.accuracy.rms == 0.02);
  CHECK(scene.accuracy.worst_column == 0.1);
  CHECK(scene.accuracy.patch_force == 0.05);
  CHECK(scene.accuracy.field == 0.05);
  CHECK(scene.accuracy.field_peak == 0.1);
  CHECK(scene.accuracy.field_rough == 0.2);
  CHECK_FALSE(scene.wavelet);
  CHECK(scene.budget.rate == 1000);
  CHECK_FALSE(scene.budget.work);
  CHECK(scene.budget.contacts == 16);
  CHECK_FALSE(scene.store);
}

TEST_CASE("every key is read") {
  const auto scene = parse_scene(R"(
    [volume]
    file = "liver.msh"
    size = "12 cm"
    [remesh]
    levels = 5
    [material]
    young = "3.5 MPa"
    poisson = -0.2
    [[fixed]]
    box = [[0, 0.1, 0.2], [0.3, 0.4, 0.5]]
    [[fixed]]
    sphere = { center = [0.5, 0.5, 1], radius = "2 cm" }
    [[touched]]
    above = 0.75
    axis = "z"
    [[read]]
    near = [1, 0.5, 0]
    count = 7
    [[read]]
    sphere = { center = [0, 0, 0], radius = 0.25 }
    [constraints]
    coarsest = 2
    [accuracy]
    rms = 0.01
    worst_column = 0.1
    patch_force = 0.2
    field = 0.03
    field_peak = 0.25
    field_rough = 0.35
    [compression]
    wavelet = "linear"
    [budget]
    rate = "500 Hz"
    work = 123456
    contacts = 64
    [store]
    file = "../liver.h5"
  )",
                                 "models/a/scene.toml");
  CHECK(scene.mesh.tetrahedra);
  CHECK(scene.mesh.size == 0.12);
  CHECK(scene.remesh.levels == 5);
  CHECK(scene.material.young == 3.5e6);
  CHECK(scene.material.poisson == -0.2);
  REQUIRE(scene.fixed.size() == 2);
  CHECK(std::get<BoxRegion>(scene.fixed[0]).low == Eigen::Vector3d(0, 0.1, 0.2));
  CHECK(std::get<BoxRegion>(scene.fixed[0]).high == Eigen::Vector3d(0.3, 0.4, 0.5));
  CHECK(std::get<SphereRegion>(scene.fixed[1]).radius == 0.02);
  CHECK(std::get<SphereRegion>(scene.fixed[1]).radius_in_metres);
  REQUIRE(scene.touched.size() == 1);
  CHECK_FALSE(std::get<HalfSpace>(scene.touched[0]).below);
  REQUIRE(scene.read.size() == 2);
  CHECK(std::get<NearestRegion>(scene.read[0]).count == 7);
  CHECK_FALSE(std::get<SphereRegion>(scene.read[1]).radius_in_metres);
  CHECK(scene.coarsest_constraints == 2);
  CHECK(scene.accuracy.rms == 0.01);
  CHECK(scene.accuracy.worst_column == 0.1);
  CHECK(scene.accuracy.patch_force == 0.2);
  CHECK(scene.accuracy.field == 0.03);
  CHECK(scene.accuracy.field_peak == 0.25);
  CHECK(scene.accuracy.field_rough == 0.35);
  CHECK(scene.wavelet == greenloop::layout::Wavelet::linear);
  CHECK(scene.budget.rate == 500);
  CHECK(scene.budget.work == 123456);
  CHECK(scene.budget.contacts == 64);
  CHECK(scene.store == "models/liver.h5");
}

TEST_CASE("the canonical text parses to itself") {
  const auto text =
      smallest +
      "[[touched]]\nsphere = { center = [0.1, 0.2, 0.3], radius = \"1 in\" }\n[[read]]\nnear = [1, 1, 0]\n"
      "[[read]]\nbox = [[0, 0, 0], [1e-20, 1, 1]]\n[budget]\nwork = 77\n[store]\nfile = \"a \\\"b\\\\c\\u0001.h5\"\n";
  const auto canonical = canonical_text(parse_scene(text, "scene.toml"));
  CHECK(canonical_text(parse_scene(canonical, "scene.toml")) == canonical);
  CHECK(canonical.find("radius = \"0.0254 m\"") != std::string::npos);
}

TEST_CASE("scenes that mean the same have the same canonical text") {
  const auto longer =
      "# a comment\n" + with("\"20 kPa\"", "'0.02  MPa'") + "[budget]\nrate = \"1000 Hz\"\ncontacts = 16\n";
  const auto a = canonical_text(parse_scene(smallest, "scene.toml"));
  const auto b = canonical_text(parse_scene(longer, "other.toml"));
  CHECK(a == b);
  CHECK(fingerprint(a) == fingerprint(b));
}

TEST_CASE("a scene that differs has another canonical text") {
  CHECK(canonical_text(parse_scene(smallest, "s.toml")) != canonical_text(parse_scene(with("0.1", "0.2"), "s.toml")));
}

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

TEST_CASE("a vertex map is kept if the scene says so, and only then part of the canonical text") {
  CHECK(!parse_scene(smallest, "s.toml").mesh.keep_vertex_map);
  const Scene asks = parse_scene(with("unit =", "keep_vertex_map = true\nunit ="), "s.toml");
  CHECK(asks.mesh.keep_vertex_map);
  CHECK(parse_scene(canonical_text(asks), "s.toml").mesh.keep_vertex_map);
  const Scene declines = parse_scene(with("unit =", "keep_vertex_map = false\nunit ="), "s.toml");
  CHECK(canonical_text(declines) == canonical_text(parse_scene(smallest, "s.toml")));
}

TEST_CASE("refused: a vertex map that is no flag, and one of a volume") {
  check_refused(with("unit =", "keep_vertex_map = 1\nunit ="),
                {":3:19: surface.keep_vertex_map: is a whole number; expected true or false"});
  check_refused(with("[surface]", "[volume]\nkeep_vertex_map = true"),
                {"volume.keep_vertex_map: does not go with [volume]"});
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

TEST_CASE("patch forces and fields may be off by more than themselves, but neither not at all nor tenfold") {
  CHECK(parse_scene(smallest + "[accuracy]\npatch_force = 1.5\n", "s.toml").accuracy.patch_force == 1.5);
  for (const std::string key : {"patch_force", "field", "field_peak", "field_rough"}) {
    CAPTURE(key);
    CHECK_NOTHROW(static_cast<void>(parse_scene(smallest + "[accuracy]\n" + key + " = 1.5\n", "s.toml")));
    check_refused(smallest + "[accuracy]\n" + key + " = 0\n", {"accuracy." + key + ": 0 is out of range"});
    check_refused(smallest + "[accuracy]\n" + key + " = 10\n", {"accuracy." + key + ": 10 is out of range"});
  }
  check_refused(smallest + "[accuracy]\nfield_peek = 0.1\n", {"did you mean \"field_peak\"?"});
}

TEST_CASE("every wavelet can be asked for by name, or the best") {
  for (const auto& [name, wavelet] : {std::pair("lifted linear", greenloop::layout::Wavelet::lifted_linear),
                                      {"linear", greenloop::layout::Wavelet::linear},
                                      {"lifted butterfly", greenloop::layout::Wavelet::lifted_butterfly},
                                      {"butterfly", greenloop::layout::Wavelet::butterfly}}) {
    CHECK(parse_scene(smallest + "[compression]\nwavelet = \"" + name + "\"\n", "s.toml").wavelet == wavelet);
  }
  CHECK_FALSE(parse_scene(smallest + "[compression]\nwavelet = \"auto\"\n", "s.toml").wavelet);
}

TEST_CASE("refused: a wavelet that is none") {
  check_refused(smallest + "[compression]\nwavelet = \"haar\"\n",
                {"compression.wavelet: \"haar\" is no wavelet", "\"auto\"", "\"lifted butterfly\""});
  check_refused(smallest + "[compression]\nwavelt = \"linear\"\n", {"did you mean \"wavelet\"?"});
}

TEST_CASE("patch force, field and wavelet are part of the canonical text") {
  for (const char* key : {"[accuracy]\npatch_force = 0.2\n", "[accuracy]\nfield = 0.2\n",
                          "[accuracy]\nfield_peak = 0.2\n", "[accuracy]\nfield_rough = 0.3\n",
                          "[compression]\nwavelet = \"linear\"\n", "[compression]\nwavelet = \"lifted butterfly\"\n"}) {
    CAPTURE(key);
    const auto canonical = canonical_text(parse_scene(smallest + key, "s.toml"));
    CHECK(canonical != canonical_text(parse_scene(smallest, "s.toml")));
    CHECK(canonical_text(parse_scene(canonical, "s.toml")) == canonical);
  }
}

TEST_CASE("refused: a rate without unit") {
  check_refused(smallest + "[budget]\nrate = 1000\n", {"budget.rate: 1000 has no unit; write for example \"1 kHz\""});
}

TEST_CASE("refused: no work at all") {
  check_refused(smallest + "[budget]\nwork = 0\n", {"budget.work: 0 is out of range"});
}

TEST_CASE("refused: contacts out of range") {
  check_refused(smallest + "[budget]\ncontacts = 0\n", {"budget.contacts: 0 is out of range"});
  check_refused(smallest + "[budget]\ncontacts = 4097\n", {"budget.contacts: 4097 is out of range"});
}

TEST_CASE("refused: a store without file") {
  check_refused(smallest + "[store]\n", {":10:1: store.file: missing; write for example file = \"bear.h5\""});
}

TEST_CASE("refused: a scene file that is not there") {
  CHECK_THROWS_WITH_AS(static_cast<void>(read_scene("no/such/scene.toml")), "no/such/scene.toml: cannot be read",
                       SceneError);
}

TEST_CASE("the examples are accepted: the files, and the one in the documentation") {
  CHECK(read_scene(GREENLOOP_SOURCE "/offline/scene/examples/bear.toml").mesh.name == "bear_bis.off");
  CHECK(read_scene(GREENLOOP_SOURCE "/offline/scene/examples/bunny.toml").mesh.name == "bunny.obj");
  for (const std::string name : {"blob", "ear", "bowl", "handle", "web"}) {
    CHECK(read_scene(GREENLOOP_SOURCE "/offline/scene/examples/" + name + ".toml").mesh.name == name + ".off");
  }
  std::ifstream stream(GREENLOOP_SOURCE "/docs/scene.md");
  const std::string page(std::istreambuf_iterator<char>(stream), {});
  const auto begin = page.find("```toml\n");
  REQUIRE(begin != std::string::npos);
  const auto end = page.find("```\n", begin + 8);
  REQUIRE(end != std::string::npos);
  const auto scene = parse_scene(page.substr(begin + 8, end - begin - 8), "docs/scene.md");
  CHECK(scene.touched.size() == 2);
  CHECK(scene.store == "docs/bear.h5");
}

TEST_CASE("a mesh is scaled by its unit or to its size") {
  const Eigen::AlignedBox3d box(Eigen::Vector3d(-1, 0, 0), Eigen::Vector3d(1, 4, 3));
  CHECK(parse_scene(smallest, "s.toml").mesh.scale(box) == 0.01);
  CHECK(parse_scene(with("unit = \"cm\"", "size = \"2 m\""), "s.toml").mesh.scale(box) == 0.5);
}

TEST_CASE("refused: a size for a mesh without extent") {
  const auto scene = parse_scene(with("unit = \"cm\"", "size = \"2 m\""), "s.toml");
  CHECK_THROWS_AS(static_cast<void>(scene.mesh.scale(Eigen::AlignedBox3d())), SceneError);
}
