// write_synthetic_models FOLDER: one synthetic model of every kind, as .gloop files to start fuzzing from, and
// "small_sphere.h" and ".c" to compile.

#include <algorithm>
#include <exception>
#include <filesystem>
#include <iostream>
#include <string>

#include "formats/testing/smallest_model.hpp"
#include "formats/testing/synthetic_model.hpp"
#include "formats/write/c_array.hpp"
#include "formats/write/describe.hpp"

namespace greenloop {
namespace {

void write_all(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  write_c_array(folder / "small_sphere.h", encode(synthetic_model({.levels = 2})));
  write_file(folder / "smallest.gloop", encode(smallest_model()));
  for (std::uint32_t levels = 1; levels <= 3; ++levels) {
    for (const layout::Wavelet wavelet : layout::wavelets) {
      const auto file =
          encode(synthetic_model({.levels = levels, .coarsest_constraint_level = levels / 3, .wavelet = wavelet}));
      std::string name(wavelet_name(static_cast<std::uint32_t>(wavelet)));
      std::replace(name.begin(), name.end(), ' ', '_');
      write_file(folder / ("sphere_" + std::to_string(levels) + "_" + name + ".gloop"), file);
    }
  }
  write_file(folder / "sphere_cut.gloop", truncate_to_level(encode(synthetic_model({.levels = 3})), 1));
}

}  // namespace
}  // namespace greenloop

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: write_synthetic_models FOLDER\n";
    return 2;
  }
  try {
    greenloop::write_all(argv[1]);
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 1;
  }
  return 0;
}
