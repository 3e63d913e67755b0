// write_synthetic_models FOLDER: one synthetic model of every kind, as .gloop files to start fuzzing from, and
// "small_sphere.h" and ".c" to compile.

#include <algorithm>
#include <exception>
#include <filesystem>
#include <iostream>
#include <string>
#include <string_view>

#include "formats/output/output_file.hpp"
#include "formats/testing/smallest_model.hpp"
#include "formats/testing/synthetic_model.hpp"
#include "formats/write/c_array.hpp"
#include "formats/write/describe.hpp"

namespace greenloop {
namespace {

std::string file_name(std::string_view body, std::uint32_t levels, layout::Wavelet wavelet) {
  std::string name(wavelet_name(static_cast<std::uint32_t>(wavelet)));
  std::replace(name.begin(), name.end(), ' ', '_');
  return std::string(body) + "_" + std::to_string(levels) + "_" + name + ".gloop";
}

void write_all(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  write_c_array(folder / "small_sphere.h", encode(synthetic_model({.levels = 2})));
  write_file(folder / "smallest.gloop", encode(smallest_model()));
  write_file(folder / "smallest_scalar.gloop", encode(smallest_scalar_model()));
  for (std::uint32_t levels = 1; levels <= 3; ++levels) {
    for (const layout::Wavelet wavelet : layout::wavelets) {
      for (const std::uint32_t components : {1U, 3U}) {
        write_file(folder / file_name(components == 1 ? "scalar" : "sphere", levels, wavelet),
                   encode(synthetic_model({.components = components,
                                           .levels = levels,
                                           .coarsest_constraint_level = levels / 3,
                                           .wavelet = wavelet})));
      }
    }
  }
  write_file(folder / "sphere_loads.gloop", encode(synthetic_model({.levels = 2, .gravity = true, .pressures = 2})));
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
