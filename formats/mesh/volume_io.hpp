#pragma once

#include <filesystem>
#include <vector>

#include "formats/mesh/mesh_text.hpp"
#include "formats/mesh/tetrahedral_mesh.hpp"

namespace greenloop {

/// Reads a mesh of linear tetrahedra; the extension, in any case, chooses the format: Gmsh .msh (1.0, 2.x and 4.1,
/// ascii and binary), Medit .mesh (ascii) and .meshb (binary), VTK .vtk (legacy, ascii and binary) and .vtu (ascii,
/// base64 and appended arrays, also compressed by zlib), TetGen .node or .ele (both files are read), Vega .veg. Points,
/// lines and faces among the elements are skipped; other volume elements are refused. Nodes keep the file's order and
/// unit; those in no tetrahedron are dropped. If every tetrahedron is negatively oriented, all are turned. What a
/// reader passes over beyond that is appended to `notes`. Throws MeshFileError with file, line, what was found and what
/// was expected: also if only some tetrahedra are inverted, or one is flat (|det| at most 1e-12 of its longest edge
/// cubed). A file has at most largest_mesh_file bytes. Work: linear in the files' length, of compressed arrays in that
/// of what they hold. Memory: at most 32 times that.
[[nodiscard]] TetrahedralMesh read_volume(const std::filesystem::path& file, MeshNotes& notes);
[[nodiscard]] TetrahedralMesh read_volume(const std::filesystem::path& file);

/// The files that a mesh consists of, this one first.
[[nodiscard]] std::vector<std::filesystem::path> files_of_mesh(const std::filesystem::path& file);

/// Writes .msh (Gmsh 2.2), .mesh (Medit) or .vtk (legacy), all ascii. Numbers read back as the same doubles.
/// Throws MeshFileError if the extension is another one or the file cannot be written.
void write_volume(const std::filesystem::path& file, const TetrahedralMesh& mesh);

}  // namespace greenloop
