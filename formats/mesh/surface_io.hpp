#pragma once

#include <filesystem>

#include "formats/mesh/mesh_text.hpp"
#include "formats/mesh/triangle_mesh.hpp"

namespace greenloop {

/// Reads a triangle surface; the extension, in any case, chooses the format: .off (also with colours, normals and
/// texture coordinates, which are skipped), .obj (v and f; everything else skipped), .stl (ascii or binary, all its
/// solids; vertices with the same coordinates become one), .ply (ascii or binary of either byte order; only positions,
/// faces and strips kept), .vtk (legacy, ascii or binary: polygons and strips of POLYDATA), or a file of cells that
/// read_volume knows: the boundary of its tetrahedra, however they are oriented, or, if it has none, its triangles and
/// quadrilaterals (Gmsh, ascii Medit, VTK). Polygons become triangles
/// (see triangulate in polygon_mesh.hpp). Vertices stay in the file's order and unit, those that no face uses too.
/// Indices are in range and coordinates finite; nothing else is checked (see offline/surface). What a reader passes
/// over beyond that is appended to `notes`. Throws MeshFileError with file, line, what was found and what was expected.
/// The file has at most largest_mesh_file bytes. Work: linear in its length, but for polygons that are not convex (see
/// triangulate). Memory: at most 16 times its length; of cells at most 64 times, as read_volume says.
[[nodiscard]] TriangleMesh read_surface(const std::filesystem::path& file, MeshNotes& notes);
[[nodiscard]] TriangleMesh read_surface(const std::filesystem::path& file);

/// Writes .off, .obj, .ply (ascii) or .stl (ascii, which stores positions only). Numbers read back as the same doubles.
/// Throws MeshFileError if the extension is another one or the file cannot be written.
void write_surface(const std::filesystem::path& file, const TriangleMesh& mesh);

}  // namespace greenloop
