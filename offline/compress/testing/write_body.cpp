// Writes the bodies that docs/results/ measures and no collection has: generated, closed, with subdivision
// connectivity.

#include <algorithm>
#include <charconv>
#include <cstring>
#include <exception>
#include <iostream>
#include <iterator>
#include <string_view>

#include "formats/mesh/surface_io.hpp"
#include "formats/mesh/volume_io.hpp"
#include "offline/compress/testing/test_body.hpp"
#include "offline/compress/testing/thin_shapes.hpp"
#include "offline/volume/testing/shapes.hpp"

namespace {

struct Shape {
  std::string_view name, text;
  greenloop::SemiRegularMesh (*make)(int levels);
};

namespace test = greenloop::offline::test;
constexpr Shape shapes[] = {
    {"blob", "a smooth body with five lobes", test::blob},
    {"ear", "a ball with a long blade", test::ear},
    {"bowl", "an open shell", test::bowl},
    {"handle", "a ball with a handle, 40, 160, 640, 2560, ... vertices", test::handle},
    {"web", "two lumps with a web between them", test::web},
};
constexpr int most_levels = 7;

namespace volume = greenloop::offline::testing;
struct Pad {
  std::string_view name, text;
  int least_levels, most_levels;
  volume::Planes (*planes)(int levels);
};

constexpr Pad pads[] = {
    {"pad", "a gel pad of tetrahedra (.mesh, .msh, .vtk), 8, 16, 32, 64 cells across, for LEVELS 0 to 3", 0, 3,
     [](int levels) { return volume::gel_pad(6 << levels, 1 << levels, 1 << levels); }},
    {"edge_pad", "the same, finer under an edge along y, 40 or 80 cells across, for LEVELS 2 or 3", 2, 3,
     [](int levels) { return volume::edge_pad(levels - 1); }},
};

int usage(std::ostream& to) {
  to << "usage: write_body NAME LEVELS FILE\n\nWrites a generated surface of 12, 42, 162, 642, 2562, 10242, ... "
        "vertices "
        "(LEVELS 0 to "
     << most_levels << ") to FILE\n(.off, .obj, .stl or .ply). NAME is one of\n\n";
  for (const Shape& shape : shapes) to << "  " << shape.name << '\t' << shape.text << '\n';
  for (const Pad& pad : pads) to << "  " << pad.name << '\t' << pad.text << '\n';
  to << "\nScenes for them: offline/scene/examples.\n";
  return &to == &std::cerr ? 1 : 0;
}

}  // namespace

int main(int count, char** arguments) {
  if (count == 2 && std::string_view(arguments[1]) == "--help") return usage(std::cout);
  if (count != 4) return usage(std::cerr);
  const Shape* shape =
      std::find_if(std::begin(shapes), std::end(shapes), [&](const Shape& s) { return s.name == arguments[1]; });
  int levels = -1;
  const char* end = arguments[2] + std::strlen(arguments[2]);
  const auto read = std::from_chars(arguments[2], end, levels);
  const Pad* pad = std::find_if(std::begin(pads), std::end(pads), [&](const Pad& p) { return p.name == arguments[1]; });
  const bool is_pad = pad != std::end(pads);
  if (!is_pad && shape == std::end(shapes)) return usage(std::cerr);
  const int least = is_pad ? pad->least_levels : 0, most = is_pad ? pad->most_levels : most_levels;
  if (read.ptr != end || levels < least || levels > most) return usage(std::cerr);
  try {
    if (is_pad) {
      greenloop::write_volume(arguments[3], volume::box(pad->planes(levels)));
      return 0;
    }
    const greenloop::SemiRegularMesh body = shape->make(levels);
    greenloop::write_surface(arguments[3], {body.positions, greenloop::triangles_of_level(body, levels)});
  } catch (const std::exception& error) {
    std::cerr << "write_body: " << error.what() << '\n';
    return 1;
  }
  return 0;
}
