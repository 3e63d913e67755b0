#include "offline/pipeline/body_problem.hpp"

#include <doctest/doctest.h>

#include <string>

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
  for (const char* more : {"[accuracy]\nrms = 0.01\nfield = 0.02\nfield_peak = 0.5\n", "[budget]\ncontacts = 64\n",
                           "[compression]\nwavelet = \"linear\"\n", "[store]\nfile = \"bear.h5\"\n"}) {
    CAPTURE(more);
    CHECK(column_fingerprint(parse_scene(smallest + more, "s.toml"), "mesh") == of_smallest);
  }
  Scene with_map = parse_scene(smallest, "s.toml");
  with_map.mesh.keep_vertex_map = true;
  CHECK(column_fingerprint(with_map, "mesh") == of_smallest);
  CHECK(column_fingerprint(parse_scene(smallest + "[remesh]\nlevels = 2\n", "s.toml"), "mesh") != of_smallest);
  CHECK(column_fingerprint(parse_scene(smallest, "s.toml"), "another mesh") != of_smallest);
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
