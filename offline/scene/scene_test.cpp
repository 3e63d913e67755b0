#include "offline/scene/scene.hpp"

#include <doctest/doctest.h>

#include <fstream>
#include <iterator>
#include <string>

#include "offline/scene/fingerprint.hpp"
#include "offline/scene/testing/scene_texts.hpp"

using namespace greenloop::offline;
using namespace greenloop::offline::test;

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
  CHECK_FALSE(scene.accuracy.mesh_error);
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
    mesh_error = 0.5
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
  CHECK(scene.accuracy.mesh_error == 0.5);
  CHECK(scene.wavelet == greenloop::layout::Wavelet::linear);
  CHECK(scene.budget.rate == 500);
  CHECK(scene.budget.work == 123456);
  CHECK(scene.budget.contacts == 64);
  CHECK(scene.store == "models/liver.h5");
}

TEST_CASE("the share of a period that a step may take is work units, at the speed of the target") {
  const auto budget_of = [](const std::string& keys) {
    return parse_scene(smallest + "[budget]\n" + keys, "scene.toml").budget;
  };
  CHECK_FALSE(budget_of("rate = \"4 kHz\"\n").asked_work());
  const StepBudget nominal = budget_of("rate = \"4 kHz\"\nshare = 0.4\n");
  CHECK(nominal.share == 0.4);
  CHECK(nominal.step_us() == 100);
  CHECK(nominal.asked_work() == static_cast<std::int64_t>(100 * nominal_units_per_us));
  CHECK(budget_of("rate = \"4 kHz\"\nshare = 0.4\nunits_per_us = 250.5\n").asked_work() == 25050);
  CHECK(budget_of("share = 1\nunits_per_us = 1\n").asked_work() == 1000);
  const StepBudget own = budget_of("share = 0.4\nwork = 77\n");
  CHECK(own.asked_work() == 77);
  CHECK(own.step_us() == 400);
}

TEST_CASE("the canonical text says the speed that a share is taken at, and is as before without a share") {
  const auto text_of = [](const std::string& keys) {
    return canonical_text(parse_scene(smallest + "[budget]\n" + keys, "scene.toml"));
  };
  const std::string shared = text_of("share = 0.4\n");
  CHECK(shared.find("rate = \"1000 Hz\"\nshare = 0.4\nunits_per_us = 3000\ncontacts") != std::string::npos);
  CHECK(shared == text_of("share = 0.4\nunits_per_us = 3000.0\n"));
  CHECK(canonical_text(parse_scene(shared, "scene.toml")) == shared);
  CHECK(shared != text_of("share = 0.4\nunits_per_us = 3001\n"));
  CHECK(text_of("share = 0.4\nwork = 9\n").find("share = 0.4\nwork = 9\ncontacts") != std::string::npos);
  CHECK(text_of("work = 9\n").find("rate = \"1000 Hz\"\nwork = 9\ncontacts") != std::string::npos);
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

TEST_CASE("welding: as far as it takes, a length, or not by distance") {
  const Scene plain = parse_scene(smallest, "s.toml");
  CHECK(!plain.mesh.weld);
  const Scene automatic = parse_scene(with("unit =", "weld = \"auto\"\nunit ="), "s.toml");
  CHECK(!automatic.mesh.weld);
  CHECK(body_text(automatic) == body_text(plain));
  const Scene length = parse_scene(with("unit =", "weld = \"0.1 mm\"\nunit ="), "s.toml");
  CHECK(length.mesh.weld == 0.0001);
  CHECK(parse_scene(canonical_text(length), "s.toml").mesh.weld == 0.0001);
  CHECK(body_text(length) != body_text(plain));
  const Scene off = parse_scene(with("unit =", "weld = 0\nunit ="), "s.toml");
  CHECK(off.mesh.weld == 0);
  CHECK(parse_scene(canonical_text(off), "s.toml").mesh.weld == 0);
}

TEST_CASE("wrapping: none, automatic, or a length, and the largest piece if asked for; all in the canonical text") {
  const Scene plain = parse_scene(smallest, "s.toml");
  CHECK(!plain.mesh.wrap);
  CHECK(canonical_text(plain).find("wrap") == std::string::npos);
  const Scene automatic = parse_scene(with("unit =", "wrap = \"auto\"\npieces = \"one\"\nunit ="), "s.toml");
  REQUIRE(automatic.mesh.wrap);
  CHECK(!automatic.mesh.wrap->length);
  CHECK(!automatic.mesh.wrap->largest_piece);
  CHECK(body_text(automatic) != body_text(plain));
  CHECK(parse_scene(canonical_text(automatic), "s.toml").mesh.wrap);
  const Scene length = parse_scene(with("unit =", "wrap = \"2 mm\"\npieces = \"largest\"\nunit ="), "s.toml");
  CHECK(length.mesh.wrap->length == 0.002);
  const Scene again = parse_scene(canonical_text(length), "s.toml");
  CHECK(again.mesh.wrap->length == 0.002);
  CHECK(again.mesh.wrap->largest_piece);
  CHECK(body_text(length) != body_text(automatic));
}

TEST_CASE("cavities: only if asked for, and another body then") {
  const Scene plain = parse_scene(smallest, "s.toml");
  CHECK(!plain.mesh.cavities);
  const Scene hollow = parse_scene(with("unit =", "cavities = true\nunit ="), "s.toml");
  CHECK(hollow.mesh.cavities);
  CHECK(parse_scene(canonical_text(hollow), "s.toml").mesh.cavities);
  CHECK(body_text(hollow) != body_text(plain));
}

TEST_CASE("a vertex map is kept if the scene says so, and only then part of the canonical text") {
  CHECK(!parse_scene(smallest, "s.toml").mesh.keep_vertex_map);
  const Scene asks = parse_scene(with("unit =", "keep_vertex_map = true\nunit ="), "s.toml");
  CHECK(asks.mesh.keep_vertex_map);
  CHECK(parse_scene(canonical_text(asks), "s.toml").mesh.keep_vertex_map);
  const Scene declines = parse_scene(with("unit =", "keep_vertex_map = false\nunit ="), "s.toml");
  CHECK(canonical_text(declines) == canonical_text(parse_scene(smallest, "s.toml")));
}

TEST_CASE("quadratic elements if the scene says so; then they belong to what the columns follow from") {
  const Scene plain = parse_scene(smallest, "s.toml");
  CHECK(plain.elements == greenloop::Elements::linear);
  CHECK(canonical_text(parse_scene(smallest + "\n[solve]\nelements = \"linear\"\n", "s.toml")) ==
        canonical_text(plain));
  const Scene asks = parse_scene(smallest + "\n[solve]\nelements = \"quadratic\"\n", "s.toml");
  CHECK(asks.elements == greenloop::Elements::quadratic);
  CHECK(body_text(asks) != body_text(plain));
  CHECK(parse_scene(canonical_text(asks), "s.toml").elements == greenloop::Elements::quadratic);
}

TEST_CASE("a model is made ready if the scene says so, and only then is it part of the canonical text") {
  CHECK(!parse_scene(smallest, "s.toml").ready);
  const Scene asks = parse_scene(smallest + "\n[compression]\nready = true\n", "s.toml");
  CHECK(asks.ready);
  CHECK(!asks.wavelet);
  CHECK(parse_scene(canonical_text(asks), "s.toml").ready);
  const Scene declines = parse_scene(smallest + "\n[compression]\nready = false\n", "s.toml");
  CHECK(canonical_text(declines) == canonical_text(parse_scene(smallest, "s.toml")));
}

TEST_CASE("patch forces and fields may be off by more than themselves, but neither not at all nor tenfold") {
  CHECK(parse_scene(smallest + "[accuracy]\npatch_force = 1.5\n", "s.toml").accuracy.patch_force == 1.5);
  for (const std::string key : {"patch_force", "field", "field_peak", "field_rough", "mesh_error"}) {
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

TEST_CASE("patch force, field and wavelet are part of the canonical text") {
  for (const char* key :
       {"[accuracy]\npatch_force = 0.2\n", "[accuracy]\nfield = 0.2\n", "[accuracy]\nfield_peak = 0.2\n",
        "[accuracy]\nfield_rough = 0.3\n", "[accuracy]\nmesh_error = 0.05\n", "[compression]\nwavelet = \"linear\"\n",
        "[compression]\nwavelet = \"lifted butterfly\"\n"}) {
    CAPTURE(key);
    const auto canonical = canonical_text(parse_scene(smallest + key, "s.toml"));
    CHECK(canonical != canonical_text(parse_scene(smallest, "s.toml")));
    CHECK(canonical_text(parse_scene(canonical, "s.toml")) == canonical);
  }
}

TEST_CASE("the examples are accepted: the files, and the one in the documentation") {
  CHECK(read_scene(GREENLOOP_SOURCE "/offline/scene/examples/bear.toml").mesh.name == "bear_bis.off");
  CHECK(read_scene(GREENLOOP_SOURCE "/offline/scene/examples/bunny.toml").mesh.name == "bunny.obj");
  for (const std::string name : {"blob", "ear", "bowl", "handle", "web"}) {
    CHECK(read_scene(GREENLOOP_SOURCE "/offline/scene/examples/" + name + ".toml").mesh.name == name + ".off");
  }
  CHECK(read_scene(GREENLOOP_SOURCE "/offline/scene/examples/rubber.toml").simulation->impulses.size() == 5);
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

TEST_CASE("numbers that TOML would read otherwise are written out as what they are") {
  for (const std::string value : {"-0", "-0.0"}) {
    const auto text = canonical_text(parse_scene(with("poisson = 0.4", "poisson = " + value), "s.toml"));
    CHECK(text.find("poisson = 0\n") != std::string::npos);
    CHECK(canonical_text(parse_scene(text, "s.toml")) == text);
  }
  const auto young = canonical_text(parse_scene(with("20 kPa", "123456789012345680000 Pa"), "s.toml"));
  CHECK(young.find(".0 Pa") != std::string::npos);
  CHECK(canonical_text(parse_scene(young, "s.toml")) == young);
}

TEST_CASE("a mesh is scaled by its unit or to its size") {
  const Eigen::AlignedBox3d box(Eigen::Vector3d(-1, 0, 0), Eigen::Vector3d(1, 4, 3));
  CHECK(parse_scene(smallest, "s.toml").mesh.scale(box) == 0.01);
  CHECK(parse_scene(with("unit = \"cm\"", "size = \"2 m\""), "s.toml").mesh.scale(box) == 0.5);
}
