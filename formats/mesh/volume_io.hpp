#pragma once

#include <filesystem>

#include "formats/mesh/mesh_text.hpp"
#include "formats/mesh/tetrahedral_mesh.hpp"

namespace greenloop {

/// Reads a mesh of linear tetrahedra; the extension chooses the format: Gmsh .msh (1.0, 2.x and 4.1, ascii), Medit
/// .mesh, VTK .vtk (legacy, ascii) and .vtu (ascii, inline), TetGen .node or .ele (both files are read), Vega .veg.
/// Points, lines and faces among the elements are skipped; other volume elements are refused. Nodes keep the file's
/// order and unit; those in no tetrahedron are dropped. If every tetrahedron is negatively oriented, all are turned.
/// Throws MeshFileError with file, line, what was found and what was expected: also if only some tetrahedra are
/// inverted, or one is flat (|det| at most 1e-12 of its longest edge cubed). Work: linear in the file's length.
[[nodiscard]] TetrahedralMesh read_volume(const std::filesystem::path& file);

/// Writes .msh (Gmsh 2.2), .mesh (Medit) or .vtk (legacy), all ascii. Numbers read back as the same doubles.
/// Throws MeshFileError if the extension is another one or the file cannot be written.
void write_volume(const std::filesystem::path& file, const TetrahedralMesh& mesh);

}  // namespace greenloop
