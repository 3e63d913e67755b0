// Wavefront OBJ: "v x y z" and "f i/t/n ..." lines; indices from 1, or counted back from the last vertex if negative.
#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "formats/mesh/surface_formats.hpp"

namespace greenloop {
namespace {

/// What has no part in a surface of polygons.
constexpr std::array<std::string_view, 19> skipped{
    "vt", "vn",     "vp",     "g",     "s",   "o",        "mg",       "usemtl",     "mtllib",   "p",
    "l",  "usemap", "maplib", "bevel", "lod", "c_interp", "d_interp", "shadow_obj", "trace_obj"};

bool is_skipped(std::string_view keyword) {
  return std::any_of(skipped.begin(), skipped.end(), [&](std::string_view word) { return same_word(word, keyword); });
}

/// The vertex of a face corner such as "7", "7/1", "7//3" or "-1"; one that comes only later is allowed.
std::optional<std::int64_t> corner_vertex(std::string_view corner, std::size_t vertex_count) {
  const auto digits = corner.substr(0, corner.find('/'));
  std::int64_t index = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), index);
  const bool whole = error == std::errc{} && end == digits.data() + digits.size();
  const auto count = static_cast<std::int64_t>(vertex_count);
  if (!whole || index == 0 || index > largest_index || index < -count) {
    return std::nullopt;
  }
  return index > 0 ? index - 1 : count + index;
}

std::string expected_vertex(std::size_t count) {
  return "a vertex of a face (a whole number, 1 to " + std::to_string(count) + ", or -1 to -" + std::to_string(count) +
         " counted back from the face)";
}

void read_face(MeshText& text, PolygonMesh& mesh, std::vector<int>& polygon) {
  polygon.clear();
  while (text.more_on_line()) {
    const auto corner = text.token("a vertex of a face");
    const auto vertex = corner_vertex(corner, mesh.vertices.size());
    if (!vertex) {
      text.fail(corner, expected_vertex(mesh.vertices.size()));
    }
    polygon.push_back(static_cast<int>(*vertex));
  }
  if (polygon.size() < 3) {
    text.fail("f with " + std::to_string(polygon.size()) + " vertices", "a face of at least 3 vertices");
  }
  mesh.add(polygon, text.line_number());
}

void require_vertices(const std::filesystem::path& file, const PolygonMesh& mesh) {
  for (std::size_t face = 0; face < mesh.size(); ++face) {
    const int last = *std::max_element(mesh[face].begin(), mesh[face].end());
    if (static_cast<std::size_t>(last) >= mesh.vertices.size()) {
      throw MeshFileError(file.string() + ":" + std::to_string(mesh.lines[face]) + ": found \"" +
                          std::to_string(last + 1) + "\", expected " + expected_vertex(mesh.vertices.size()));
    }
  }
}

}  // namespace

PolygonMesh parse_obj(const std::filesystem::path& file, std::string content, MeshNotes& notes) {
  MeshText text(file, std::move(content), '#', true);
  PolygonMesh mesh;
  std::vector<int> polygon;
  std::string unknown;
  std::size_t unknown_count = 0;
  while (!text.at_end()) {
    const auto keyword = text.token("a keyword");
    if (same_word(keyword, "v")) {
      mesh.vertices.push_back(text.point());
    } else if (same_word(keyword, "f") || same_word(keyword, "fo")) {
      read_face(text, mesh, polygon);
    } else if (!is_skipped(keyword) && unknown_count++ == 0) {
      unknown = in_quotes(keyword) + " on line " + std::to_string(text.line_number());
    }
    text.skip_line();
  }
  require_vertices(file, mesh);
  if (unknown_count > 0) {
    notes.push_back(file.string() + ": " + std::to_string(unknown_count) + (unknown_count == 1 ? " line" : " lines") +
                    " of unknown keywords skipped, the first " + unknown);
  }
  return mesh;
}

std::string format_obj(const TriangleMesh& mesh) {
  std::string text;
  for (const auto& vertex : mesh.vertices) {
    text += "v ";
    append_point(text, vertex);
    text += '\n';
  }
  for (const auto& [a, b, c] : mesh.triangles) {
    text += "f " + std::to_string(a + 1) + ' ' + std::to_string(b + 1) + ' ' + std::to_string(c + 1) + '\n';
  }
  return text;
}

}  // namespace greenloop
