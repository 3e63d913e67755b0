#include "offline/pipeline/body_problem.hpp"

#include <doctest/doctest.h>

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

#include "formats/mesh/mesh_text.hpp"
#include "offline/scene/fingerprint.hpp"

namespace greenloop::offline {
namespace {

const std::string smallest = R"(
[surface]
file = "bear.off"
unit = "cm"
[material]
young = "20 kPa"
poisson = 0.4
[[fixed]]
below = 0.1
axis = "y"
)";

TEST_CASE("what the columns do not depend on does not change their fingerprint") {
  const std::string of_smallest = column_fingerprint(parse_scene(smallest, "s.toml"), "mesh");
  for (const char* more :
       {"[accuracy]\nrms = 0.01\nfield = 0.02\nfield_peak = 0.5\n", "[budget]\ncontacts = 64\n",
        "[constraints]\ncoarsest = 1\n", "[compression]\nwavelet = \"linear\"\n", "[store]\nfile = \"bear.h5\"\n"}) {
    CAPTURE(more);
    CHECK(column_fingerprint(parse_scene(smallest + more, "s.toml"), "mesh") == of_smallest);
  }
  Scene with_map = parse_scene(smallest, "s.toml");
  with_map.mesh.keep_vertex_map = true;
  CHECK(column_fingerprint(with_map, "mesh") == of_smallest);
  CHECK(column_fingerprint(parse_scene(smallest + "[remesh]\nlevels = 2\n", "s.toml"), "mesh") != of_smallest);
  CHECK(column_fingerprint(parse_scene(smallest, "s.toml"), "another mesh") != of_smallest);
}

TEST_CASE("every part of the body's text is in the fingerprint of its columns") {
  const std::string of_smallest = column_fingerprint(parse_scene(smallest, "s.toml"), "mesh");
  for (const auto& [from, to] : {std::pair("bear.off", "bull.off"), std::pair("unit = \"cm\"", "size = \"30 cm\""),
                                 std::pair("20 kPa", "21 kPa"), std::pair("poisson = 0.4", "poisson = 0.3"),
                                 std::pair("below = 0.1", "below = 0.2")}) {
    std::string other = smallest;
    other.replace(other.find(from), std::string_view(from).size(), to);
    CAPTURE(other);
    CHECK(column_fingerprint(parse_scene(other, "s.toml"), "mesh") != of_smallest);
  }
  for (const char* more : {"[[touched]]\nabove = 0.5\naxis = \"y\"\n", "[[read]]\nabove = 0.5\naxis = \"y\"\n",
                           "[[fixed]]\nabove = 0.9\naxis = \"y\"\n", "[remesh]\nbase_vertices = 50\n"}) {
    CAPTURE(more);
    CHECK(column_fingerprint(parse_scene(smallest + more, "s.toml"), "mesh") != of_smallest);
  }
}

TEST_CASE("all files of a mesh are in its bytes") {
  const auto folder = std::filesystem::temp_directory_path() / "greenloop_body_problem_test";
  std::filesystem::create_directories(folder);
  const auto bytes_with = [&](const char* nodes, const char* elements, const char* named) {
    write_file(folder / "m.node", nodes);
    write_file(folder / "m.ele", elements);
    std::string text = smallest;
    text.replace(text.find("[surface]"), 9, "[volume]");
    text.replace(text.find("bear.off"), 8, named);
    return mesh_bytes(parse_scene(text, folder / "s.toml"));
  };
  for (const char* named : {"m.node", "m.ele"}) {
    const std::string before = bytes_with("1 2", "3 4", named);
    CHECK(bytes_with("1 2", "3 4", named) == before);
    CHECK(bytes_with("1 3", "3 4", named) != before);
    CHECK(bytes_with("1 2", "3 5", named) != before);
    CHECK(bytes_with("1 23", " 4", named) != before);
  }
  std::filesystem::create_directories(folder / "bear.off");
  CHECK_THROWS_AS(mesh_bytes(parse_scene(smallest, folder / "s.toml")), MeshFileError);
}

TEST_CASE("stores made before scenes had goals for fields keep their fingerprint") {
  const std::string text = R"([surface]
file = "bear.off"
unit = "0.01 m"

[remesh]
base_vertices = 42
levels = 3

[material]
young = "20000 Pa"
poisson = 0.4

[[fixed]]
below = 0.1
axis = "y"

[constraints]
coarsest = 0

[accuracy]
rms = 0.02
worst_column = 0.1
patch_force = 0.05

[compression]
wavelet = "lifted linear"

[budget]
rate = "1000 Hz"
contacts = 16
)";
  CHECK(column_fingerprint(parse_scene(smallest, "s.toml"), "mesh") ==
        fingerprint(text, fingerprint("mesh", fingerprint(pipeline_version))).hex());
}

}  // namespace
}  // namespace greenloop::offline
