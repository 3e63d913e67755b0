// VTK surfaces in the legacy format: POLYDATA with POLYGONS and TRIANGLE_STRIPS.
#include <array>
#include <string_view>
#include <utility>
#include <vector>

#include "formats/mesh/surface_formats.hpp"
#include "formats/mesh/vtk_legacy.hpp"

namespace greenloop {
namespace {

void add_polygons(const MeshText& text, const VtkCells& cells, PolygonMesh& mesh) {
  for (std::size_t cell = 0; cell < cells.size(); ++cell) {
    if (cells[cell].size() < 3) {
      text.fail("polygon of " + std::to_string(cells[cell].size()) + " points", "at least 3 points");
    }
    mesh.add(cells[cell], cells.lines[cells.offsets[cell]]);
  }
}

/// Triangles of a strip turn in alternate senses.
void add_strips(const VtkCells& cells, PolygonMesh& mesh) {
  for (std::size_t cell = 0; cell < cells.size(); ++cell) {
    const auto strip = cells[cell];
    for (std::size_t i = 2; i < strip.size(); ++i) {
      const bool even = i % 2 == 0;
      mesh.add(std::array{strip[i - (even ? 2 : 1)], strip[i - (even ? 1 : 2)], strip[i]},
               cells.lines[cells.offsets[cell]]);
    }
  }
}

bool ends_geometry(std::string_view keyword) {
  return same_word(keyword, "POINT_DATA") || same_word(keyword, "CELL_DATA");
}

void read_cells(VtkLegacy& vtk, std::string_view keyword, PolygonMesh& mesh) {
  if (same_word(keyword, "POLYGONS")) {
    add_polygons(vtk.text(), vtk.read_cells(mesh.vertices.size()), mesh);
  } else if (same_word(keyword, "TRIANGLE_STRIPS")) {
    add_strips(vtk.read_cells(mesh.vertices.size()), mesh);
  } else if (same_word(keyword, "VERTICES") || same_word(keyword, "LINES")) {
    static_cast<void>(vtk.read_cells(mesh.vertices.size()));
  } else {
    vtk.text().fail(keyword, "POINTS, POLYGONS, TRIANGLE_STRIPS, VERTICES or LINES");
  }
}

}  // namespace

PolygonMesh parse_vtk_surface(const std::filesystem::path& file, std::string content, MeshNotes& /*notes*/) {
  VtkLegacy vtk(file, std::move(content), "POLYDATA");
  PolygonMesh mesh;
  while (!vtk.text().at_end()) {
    const auto keyword = vtk.text().token("a keyword");
    if (ends_geometry(keyword)) {
      break;
    }
    if (same_word(keyword, "POINTS")) {
      mesh.vertices = vtk.read_points();
    } else if (!vtk.skip_part(keyword)) {
      read_cells(vtk, keyword, mesh);
    }
  }
  return mesh;
}

}  // namespace greenloop
