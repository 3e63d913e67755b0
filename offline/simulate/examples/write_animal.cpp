// Writes the animal of the scene rubber.toml.

#include <cstdlib>
#include <exception>
#include <iostream>
#include <string_view>

#include "formats/mesh/surface_io.hpp"
#include "offline/simulate/examples/animal.hpp"

int main(int count, char** arguments) {
  const std::string_view levels = count == 3 ? arguments[1] : "";
  if (levels.size() != 1 || levels[0] < '0' || levels[0] > '6') {
    std::cerr << "usage: write_animal LEVELS FILE\n\nWrites a spiny animal, its cage split LEVELS (0 to 6) times, to "
                 "FILE (.off, .obj, .stl or .ply).\n";
    return 1;
  }
  try {
    greenloop::write_surface(arguments[2], greenloop::offline::examples::animal(levels[0] - '0'));
  } catch (const std::exception& error) {
    std::cerr << "write_animal: " << error.what() << '\n';
    return 1;
  }
  return 0;
}
