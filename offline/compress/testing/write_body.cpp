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
constexpr int most_levels = 7, most_pad_levels = 3;

void write_pad(int levels, const char* file) {
  namespace volume = greenloop::offline::testing;
  greenloop::write_volume(file, volume::box(volume::gel_pad(6 << levels, 1 << levels, 1 << levels)));
}

int usage(std::ostream& to) {
  to << "usage: write_body NAME LEVELS FILE\n\nWrites a generated surface of 12, 42, 162, 642, 2562, 10242, ... "
        "vertices "
        "(LEVELS 0 to "
     << most_levels << ") to FILE\n(.off, .obj, .stl or .ply). NAME is one of\n\n";
  for (const Shape& shape : shapes) to << "  " << shape.name << '\t' << shape.text << '\n';
  to << "  pad\ta gel pad of tetrahedra (.mesh, .msh, .vtk), 8, 16, 32, 64 cells across, for LEVELS 0 to 3\n";
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
  const bool is_pad = std::string_view(arguments[1]) == "pad";
  if (is_pad ? levels > most_pad_levels : shape == std::end(shapes)) return usage(std::cerr);
  if (read.ptr != end || levels < 0 || levels > most_levels) return usage(std::cerr);
  try {
    if (is_pad) {
      write_pad(levels, arguments[3]);
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
