#pragma once

// The formats behind read_surface and write_surface, one function each.

#include <filesystem>
#include <string>

#include "formats/mesh/mesh_text.hpp"
#include "formats/mesh/polygon_mesh.hpp"
#include "formats/mesh/triangle_mesh.hpp"

namespace greenloop {

[[nodiscard]] PolygonMesh parse_off(const std::filesystem::path& file, std::string content, MeshNotes& notes);
[[nodiscard]] PolygonMesh parse_obj(const std::filesystem::path& file, std::string content, MeshNotes& notes);
[[nodiscard]] PolygonMesh parse_stl(const std::filesystem::path& file, std::string content, MeshNotes& notes);
[[nodiscard]] PolygonMesh parse_ply(const std::filesystem::path& file, std::string content, MeshNotes& notes);
[[nodiscard]] PolygonMesh parse_vtk_surface(const std::filesystem::path& file, std::string content, MeshNotes& notes);

[[nodiscard]] std::string format_off(const TriangleMesh& mesh);
[[nodiscard]] std::string format_obj(const TriangleMesh& mesh);
[[nodiscard]] std::string format_stl(const TriangleMesh& mesh);
[[nodiscard]] std::string format_ply(const TriangleMesh& mesh);

/// Appends the body of OFF and of ASCII PLY: a line of coordinates for each vertex, then "3 a b c" for each triangle.
void append_corner_lists(std::string& text, const TriangleMesh& mesh);

}  // namespace greenloop
