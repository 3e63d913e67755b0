// Coverage-guided fuzzing of the mesh readers: mesh_fuzz FOLDER, where FOLDER holds files to start from, each with a
// byte before it that names the reader. Built by the option GREENLOOP_BUILD_FUZZERS.

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

#include "formats/mesh/surface_formats.hpp"
#include "formats/mesh/volume_formats.hpp"

namespace {

using namespace greenloop;

constexpr std::array surfaces{parse_off, parse_obj, parse_stl, parse_ply, parse_vtk_surface};
constexpr std::array volumes{parse_gmsh, parse_medit, parse_vtk, parse_vtu, parse_vega};

void read(std::size_t reader, std::string content) {
  MeshNotes notes;
  if (reader < surfaces.size()) {
    static_cast<void>(triangulate("m", surfaces[reader]("m", std::move(content), notes), notes));
  } else {
    auto cells = volumes[reader - surfaces.size()]("m", std::move(content), notes);
    static_cast<void>(VolumeBuilder(cells).skin(notes));
    static_cast<void>(cells.finish());
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  try {
    read(data[0] % (surfaces.size() + volumes.size()), {reinterpret_cast<const char*>(data) + 1, size - 1});
  } catch (const MeshFileError&) {  // refused
  }
  return 0;
}
