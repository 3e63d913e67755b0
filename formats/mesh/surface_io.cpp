#include "formats/mesh/surface_io.hpp"

#include <string>
#include <string_view>
#include <utility>

#include "formats/mesh/surface_formats.hpp"
#include "formats/mesh/volume_formats.hpp"

namespace greenloop {
namespace {

constexpr const char* surface_file =
    "a surface file: .off, .obj, .stl, .ply or .vtk, or tetrahedra, whose boundary is taken: .msh, .mesh, .meshb, "
    ".vtu, "
    ".node, .ele or .veg";
constexpr const char* written_surface = "a surface file: .off, .obj, .stl or .ply";

using ParseSurface = PolygonMesh (*)(const std::filesystem::path&, std::string, MeshNotes&);

ParseSurface parser_of(const std::filesystem::path& file) {
  const auto extension = lower_extension(file);
  return extension == ".off"   ? parse_off
         : extension == ".obj" ? parse_obj
         : extension == ".stl" ? parse_stl
         : extension == ".ply" ? parse_ply
         : extension == ".vtk" ? parse_vtk_surface
                               : nullptr;
}

/// Whether a legacy VTK file holds cells of any kind, not a surface.
bool is_vtk_grid(const std::filesystem::path& file, std::string_view content) {
  constexpr std::size_t header = 1024;
  return lower_extension(file) == ".vtk" &&
         content.substr(0, header).find("DATASET UNSTRUCTURED_GRID") != std::string_view::npos;
}

TriangleMesh read_triangles(const std::filesystem::path& file, MeshNotes& notes) {
  if (auto* const parse = parser_of(file)) {
    auto content = read_file(file);
    if (!is_vtk_grid(file, content)) return triangulate(file, parse(file, std::move(content), notes), notes);
  }
  auto cells = read_cells(file, notes);
  if (!cells) refuse_extension(file, surface_file);
  return cells->skin(notes);
}

}  // namespace

void append_corner_lists(std::string& text, const TriangleMesh& mesh) {
  for (const auto& vertex : mesh.vertices) {
    append_point(text, vertex);
    text += '\n';
  }
  for (const auto& [a, b, c] : mesh.triangles) {
    text += "3 " + std::to_string(a) + ' ' + std::to_string(b) + ' ' + std::to_string(c) + '\n';
  }
}

TriangleMesh read_surface(const std::filesystem::path& file, MeshNotes& notes) {
  auto mesh = read_triangles(file, notes);
  if (mesh.triangles.empty()) {
    throw MeshFileError(file.string() + ": found no face, expected a surface");
  }
  return mesh;
}

TriangleMesh read_surface(const std::filesystem::path& file) {
  MeshNotes unheard;
  return read_surface(file, unheard);
}

void write_surface(const std::filesystem::path& file, const TriangleMesh& mesh) {
  const auto extension = lower_extension(file);
  auto* const format = extension == ".off"   ? format_off
                       : extension == ".obj" ? format_obj
                       : extension == ".stl" ? format_stl
                       : extension == ".ply" ? format_ply
                                             : nullptr;
  if (format == nullptr) {
    refuse_extension(file, written_surface);
  }
  write_file(file, format(mesh));
}

}  // namespace greenloop
