#include <array>
#include <string>

#include "offline/scene/scene.hpp"
#include "rt_tests/fuzz/doors.hpp"

namespace greenloop {
namespace {

const std::array<std::string, 2> seeds = {R"([surface]
file = "bear.off"
size = "30 cm"
weld = "2 um"
keep_vertex_map = true
[remesh]
base_vertices = 42
levels = 3
[material]
young = "20 kPa"
poisson = 0.4
density = "1.1 g/cm3"
[[fixed]]
below = 0.19
axis = "y"
[[loads]]
gravity = true
[[loads]]
name = "palm"
near = [0.5, 1, 0.5]
count = 40
direction = [0, -1, 0.5]
[[touched]]
sphere = { center = [0.5, 0.4, 0.8], radius = "3 cm" }
[[read]]
box = [[0, 0, 0.5], [1, 1, 1]]
[constraints]
coarsest = 1
[accuracy]
rms = 0.02
worst_column = 0.1
patch_force = 0.05
field = 0.05
field_peak = 0.1
[compression]
wavelet = "auto"
[budget]
rate = "1 kHz"
work = 200000
contacts = 16
[store]
file = "bear.h5"
)",
                                          R"([volume]
file = 'liver.msh'
unit = "2.5 mm"
[material]
young = "3.5e-1 N/mm^2"
poisson = -0.2
[[fixed]]
above = 0.75
axis = "z"
[budget]
rate = "500 Hz"
share = 0.5
units_per_us = 1000
)"};

class SceneDoor final : public Door {
 public:
  bool try_one(Random& random) override {
    std::string text = one_of(random, seeds);
    mutate_text(random, text);
    std::string written;
    try {
      written = offline::canonical_text(offline::parse_scene(text, "scene.toml"));
    } catch (const offline::SceneError&) {
      return false;
    }
    require_right(offline::canonical_text(offline::parse_scene(written, "scene.toml")) == written,
                  "a scene that was written out is another scene");
    return true;
  }
};

}  // namespace

std::unique_ptr<Door> scene_door() { return std::make_unique<SceneDoor>(); }

}  // namespace greenloop
