// Object File Format: "OFF", counts of vertices, faces and edges, then the vertices, then the faces.
#include <cstddef>
#include <utility>
#include <vector>

#include "formats/mesh/surface_formats.hpp"

namespace greenloop {
namespace {

/// Reads the header; true if vertices carry more than their position.
bool read_header(MeshText& text) {
  const auto header = text.token("\"OFF\"");
  if (header != "OFF" && header != "COFF" && header != "NOFF" && header != "CNOFF") {
    text.fail(header, "\"OFF\", \"COFF\", \"NOFF\" or \"CNOFF\"");
  }
  if (text.peek() == "BINARY") {
    text.fail(text.token(""), "an ascii OFF file");
  }
  return header != "OFF";
}

}  // namespace

TriangleMesh parse_off(const std::filesystem::path& file, std::string content) {
  MeshText text(file, std::move(content), '#');
  const bool extra = read_header(text);
  const auto vertex_count = text.count("the number of vertices", 6);
  const auto face_count = text.count("the number of faces", 8);
  text.skip_line();

  TriangleMesh mesh;
  mesh.vertices.reserve(vertex_count);
  for (std::size_t i = 0; i < vertex_count; ++i) {
    mesh.vertices.push_back(text.point());
    if (extra) {
      text.skip_line();
    }
  }
  mesh.triangles.reserve(face_count);
  std::vector<int> polygon;
  for (std::size_t i = 0; i < face_count; ++i) {
    polygon.resize(static_cast<std::size_t>(text.integer("the number of vertices of a face", 3, 65536)));
    for (int& vertex : polygon) {
      vertex = static_cast<int>(text.integer("a vertex index", 0, static_cast<std::int64_t>(vertex_count) - 1));
    }
    append_fan(mesh, polygon);
    text.skip_line();
  }
  return mesh;
}

std::string format_off(const TriangleMesh& mesh) {
  std::string text =
      "OFF\n" + std::to_string(mesh.vertices.size()) + ' ' + std::to_string(mesh.triangles.size()) + " 0\n";
  append_corner_lists(text, mesh);
  return text;
}

}  // namespace greenloop
