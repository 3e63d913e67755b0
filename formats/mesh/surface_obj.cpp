// Wavefront OBJ: "v x y z" and "f i/t/n ..." lines; indices from 1, or counted back from the last vertex if negative.
#include <charconv>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

#include "formats/mesh/surface_formats.hpp"

namespace greenloop {
namespace {

/// The vertex of a face corner such as "7", "7/1", "7//3" or "-1".
int corner_vertex(const MeshText& text, std::string_view corner, std::size_t vertex_count) {
  const auto digits = corner.substr(0, corner.find('/'));
  const auto count = static_cast<std::int64_t>(vertex_count);
  std::int64_t index = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), index);
  const bool whole = error == std::errc{} && end == digits.data() + digits.size();
  if (!whole || index == 0 || index > count || index < -count) {
    text.fail(corner, "a vertex of a face (a whole number, 1 to " + std::to_string(count) + " so far, or -1 to -" +
                          std::to_string(count) + ")");
  }
  return static_cast<int>(index > 0 ? index - 1 : count + index);
}

void read_face(MeshText& text, TriangleMesh& mesh, std::vector<int>& polygon) {
  polygon.clear();
  while (text.more_on_line()) {
    polygon.push_back(corner_vertex(text, text.token("a vertex of a face"), mesh.vertices.size()));
  }
  if (polygon.size() < 3) {
    text.fail("f with " + std::to_string(polygon.size()) + " vertices", "a face of at least 3 vertices");
  }
  append_fan(mesh, polygon);
}

}  // namespace

TriangleMesh parse_obj(const std::filesystem::path& file, std::string content) {
  MeshText text(file, std::move(content), '#');
  TriangleMesh mesh;
  std::vector<int> polygon;
  while (!text.at_end()) {
    const auto keyword = text.token("a keyword");
    if (keyword == "v") {
      mesh.vertices.push_back(text.point());
    } else if (keyword == "f") {
      read_face(text, mesh, polygon);
    }
    text.skip_line();
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
