#pragma once

#include <filesystem>

#include "formats/mesh/mesh_text.hpp"
#include "formats/mesh/triangle_mesh.hpp"

namespace greenloop {

/// Reads a triangle surface; the extension chooses the format: .off (also COFF and NOFF, colours and normals skipped),
/// .obj (v and f; everything else skipped), .stl (ascii or binary; vertices with the same coordinates become one),
/// .ply (ascii or binary little endian; only positions and faces kept).
/// Polygons become a fan of triangles around their first vertex. Vertices stay in the file's order and unit, those that
/// no face uses too. Indices are in range and coordinates finite; nothing else is checked (see offline/surface).
/// Throws MeshFileError with file, line, what was found and what was expected. Work: linear in the file's length.
[[nodiscard]] TriangleMesh read_surface(const std::filesystem::path& file);

/// Writes .off, .obj, .ply (ascii) or .stl (ascii, which stores positions only). Numbers read back as the same doubles.
/// Throws MeshFileError if the extension is another one or the file cannot be written.
void write_surface(const std::filesystem::path& file, const TriangleMesh& mesh);

}  // namespace greenloop
