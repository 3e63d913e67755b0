// Writes the smooth, lobed body that docs/results.md measures: an icosahedron split LEVELS times.

#include <charconv>
#include <cstring>
#include <exception>
#include <iostream>

#include "formats/exchange/surface_io.hpp"
#include "offline/compress/test_body.hpp"

int main(int count, char** arguments) {
  int levels = -1;
  if (count == 3) std::from_chars(arguments[1], arguments[1] + std::strlen(arguments[1]), levels);
  if (levels < 0 || levels > 7) {
    std::cerr << "usage: write_blob LEVELS FILE\nWrites a smooth body of 12, 42, 162, 642, 2562, 10242, ... vertices "
                 "(LEVELS 0 to 7) to FILE (.off, .obj, .stl or .ply).\n";
    return 1;
  }
  try {
    const greenloop::SemiRegularMesh body = greenloop::offline::test::blob(levels);
    greenloop::write_surface(arguments[2], {body.positions, greenloop::triangles_of_level(body, levels)});
  } catch (const std::exception& error) {
    std::cerr << "write_blob: " << error.what() << '\n';
    return 1;
  }
  return 0;
}
