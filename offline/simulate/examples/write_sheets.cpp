// Writes the sheets of the scenes cloth.toml and plant.toml.

#include <cstdlib>
#include <exception>
#include <iostream>
#include <string_view>

#include "formats/mesh/surface_io.hpp"
#include "offline/simulate/examples/sheets.hpp"

int main(int count, char** arguments) {
  using namespace greenloop;
  const std::string_view what = count == 4 ? arguments[1] : "";
  if (what != "cloth" && what != "plant") {
    std::cerr << "usage: write_sheets cloth|plant CELLS FILE\n\nWrites a pleated cloth or the leaves of a plant, CELLS "
                 "(6 to 200) squares along each, to FILE (.off, .obj, .stl or .ply).\n";
    return 1;
  }
  try {
    const int cells = std::atoi(arguments[2]);
    write_surface(arguments[3], what == "cloth" ? offline::examples::cloth(cells) : offline::examples::plant(cells));
  } catch (const std::exception& error) {
    std::cerr << "write_sheets: " << error.what() << '\n';
    return 1;
  }
  return 0;
}
