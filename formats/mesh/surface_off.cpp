// Object File Format: "OFF", counts of vertices, faces and edges, then the vertices, then the faces.
#include <cstddef>
#include <utility>
#include <vector>

#include "formats/mesh/surface_formats.hpp"

namespace greenloop {
namespace {

/// "OFF" with what vertices carry besides a position, which is skipped: texture ST, colour C, normal N.
void read_header(MeshText& text) {
  const auto header = text.peek();
  if (!header.empty() && header.find_first_not_of("0123456789") == std::string_view::npos) {
    return;  // Geomview allows it to be left out
  }
  auto word = text.token("\"OFF\"");
  for (const std::string_view prefix : {"ST", "C", "N"}) {
    if (word.size() > 3 && same_word(word.substr(0, prefix.size()), prefix)) {
      word.remove_prefix(prefix.size());
    }
  }
  if (!same_word(word, "OFF")) {
    text.fail(header, "\"OFF\", or that with ST, C or N before it");
  }
  if (same_word(text.peek(), "BINARY")) {
    text.fail(text.token(""), "an ascii OFF file");
  }
}

/// Vertices and faces on a line each, so that what a line holds beyond them can be skipped.
bool one_item_a_line(MeshText& text, std::size_t items) {
  if (text.more_on_line()) {
    static_cast<void>(text.real("the number of edges"));
  }
  return !text.more_on_line() && text.filled_lines_left(items) >= items;
}

}  // namespace

PolygonMesh parse_off(const std::filesystem::path& file, std::string content, MeshNotes& notes) {
  MeshText text(file, std::move(content), '#');
  read_header(text);
  const auto vertex_count = text.count("the number of vertices", 6);
  const auto face_count = text.count("the number of faces", 8);
  const bool lines = one_item_a_line(text, vertex_count + face_count);

  PolygonMesh mesh;
  mesh.vertices.reserve(vertex_count);
  for (std::size_t i = 0; i < vertex_count; ++i) {
    mesh.vertices.push_back(text.point());
    if (lines) {
      text.skip_line();
    }
  }
  std::vector<int> polygon;
  for (std::size_t i = 0; i < face_count; ++i) {
    polygon.resize(static_cast<std::size_t>(text.integer("the number of vertices of a face", 1, 65536)));
    for (int& vertex : polygon) {
      vertex = static_cast<int>(text.integer("a vertex index", 0, static_cast<std::int64_t>(vertex_count) - 1));
    }
    mesh.add(polygon, text.line_number());
    if (lines) {
      text.skip_line();
    }
  }
  text.note_rest(notes, "face");
  return mesh;
}

std::string format_off(const TriangleMesh& mesh) {
  std::string text =
      "OFF\n" + std::to_string(mesh.vertices.size()) + ' ' + std::to_string(mesh.triangles.size()) + " 0\n";
  append_corner_lists(text, mesh);
  return text;
}

}  // namespace greenloop
