#include "formats/mesh/surface_io.hpp"

#include <string>

#include "formats/mesh/surface_formats.hpp"

namespace greenloop {
namespace {

constexpr const char* surface_file = "a surface file: .off, .obj, .stl, .ply or .vtk";
constexpr const char* written_surface = "a surface file: .off, .obj, .stl or .ply";

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
  const auto extension = lower_extension(file);
  auto* const parse = extension == ".off"   ? parse_off
                      : extension == ".obj" ? parse_obj
                      : extension == ".stl" ? parse_stl
                      : extension == ".ply" ? parse_ply
                      : extension == ".vtk" ? parse_vtk_surface
                                            : nullptr;
  if (parse == nullptr) {
    refuse_extension(file, surface_file);
  }
  auto mesh = triangulate(file, parse(file, read_file(file), notes), notes);
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
