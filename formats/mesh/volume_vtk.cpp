// VTK unstructured grids in the legacy format (.vtk), ascii and binary.
#include <string_view>
#include <utility>

#include "formats/mesh/volume_formats.hpp"
#include "formats/mesh/vtk_legacy.hpp"

namespace greenloop {
namespace {

constexpr std::int64_t linear_tetrahedron = 10;

/// Vertices, lines and faces: no volume.
bool is_polygon(std::int64_t type) { return type == 5 || type == 7 || type == 9; }

bool is_lower_dimensional(std::int64_t type) { return (type >= 0 && type <= 9) || (type >= 21 && type <= 23); }

}  // namespace

void add_vtk_cell(const NumberArray& numbers, const VtkCells& cells, std::size_t cell, std::int64_t type,
                  VolumeBuilder& builder) {
  if (is_lower_dimensional(type)) {
    const bool face = is_polygon(type) && cells[cell].size() >= 3;
    if (face) builder.add_face(cells[cell], cells.lines[cells.offsets[cell]]);
    return;
  }
  if (type != linear_tetrahedron) {
    numbers.fail("cell type " + std::to_string(type), "linear tetrahedra (type 10) as the only volume cells");
  }
  const auto points = cells[cell];
  if (points.size() != 4) {
    numbers.fail("tetrahedron of " + std::to_string(points.size()) + " points", "4 points");
  }
  builder.add_tetrahedron({points[0], points[1], points[2], points[3]}, cells.lines[cells.offsets[cell]]);
}

VolumeBuilder parse_vtk(const std::filesystem::path& file, std::string content, MeshNotes& /*notes*/) {
  VtkLegacy vtk(file, std::move(content), "UNSTRUCTURED_GRID");
  MeshText& text = vtk.text();
  VolumeBuilder builder(file);
  VtkCells cells;
  while (!text.at_end()) {
    const auto keyword = text.token("a keyword");
    if (same_word(keyword, "POINTS")) {
      builder.add_nodes(vtk.read_points());
    } else if (same_word(keyword, "CELLS")) {
      cells = vtk.read_cells(builder.node_count());
    } else if (same_word(keyword, "CELL_TYPES")) {
      if (text.count("the number of cells", 1) != cells.size()) {
        text.fail("CELL_TYPES of another count", std::to_string(cells.size()) + " cells");
      }
      auto types = vtk.numbers(Scalar::i32, cells.size());
      for (std::size_t cell = 0; cell < cells.size(); ++cell) {
        add_vtk_cell(types, cells, cell, types.integer("a cell type", 0, 255), builder);
      }
      break;
    } else if (!vtk.skip_part(keyword)) {
      text.fail(keyword, "POINTS, CELLS or CELL_TYPES");
    }
  }
  return builder;
}

std::string format_vtk(const TetrahedralMesh& mesh) {
  const auto cells = std::to_string(mesh.tetrahedra.size());
  std::string text = "# vtk DataFile Version 3.0\ntetrahedra\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS " +
                     std::to_string(mesh.vertices.size()) + " double\n";
  for (const auto& vertex : mesh.vertices) {
    append_point(text, vertex);
    text += '\n';
  }
  text += "CELLS " + cells + ' ' + std::to_string(5 * mesh.tetrahedra.size()) + '\n';
  for (const auto& tetrahedron : mesh.tetrahedra) {
    text += '4';
    for (const int node : tetrahedron) {
      text += ' ' + std::to_string(node);
    }
    text += '\n';
  }
  text += "CELL_TYPES " + cells + '\n';
  for (std::size_t i = 0; i < mesh.tetrahedra.size(); ++i) {
    text += "10\n";
  }
  return text;
}

}  // namespace greenloop
