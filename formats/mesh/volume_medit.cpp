// Medit (INRIA), ascii: keywords, each followed by a count and that many items; numbers from 1. Binary files are told
// by their first bytes.
#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "formats/mesh/volume_formats.hpp"

namespace greenloop {
namespace {

bool is_other_volume(std::string_view keyword) {
  constexpr std::array<std::string_view, 5> keywords{"Hexahedra", "Prisms", "Pentahedra", "Pyramids", "TetrahedraP2"};
  return std::any_of(keywords.begin(), keywords.end(), [&](auto known) { return same_word(known, keyword); });
}

void read_vertices(MeshText& text, VolumeBuilder& builder) {
  const auto count = text.count("the number of vertices", 8);
  builder.reserve_nodes(count);
  for (std::size_t i = 0; i < count; ++i) {
    builder.add_node(text, static_cast<std::int64_t>(i) + 1, text.point());
    static_cast<void>(text.real("the reference of a vertex"));
  }
}

void read_tetrahedra(MeshText& text, VolumeBuilder& builder) {
  const auto count = text.count("the number of tetrahedra", 10);
  for (std::size_t i = 0; i < count; ++i) {
    builder.read_tetrahedron(text);
    static_cast<void>(text.real("the reference of a tetrahedron"));
  }
}

void read_faces(MeshText& text, std::size_t corners, VolumeBuilder& builder) {
  const auto count = text.count("the number of faces", 8);
  std::vector<std::int64_t> nodes(corners);
  for (std::size_t i = 0; i < count; ++i) {
    const auto line = text.line_number();
    for (auto& node : nodes) node = read_number(text, "the number of a vertex");
    builder.add_face(std::span<const std::int64_t>(nodes), line);
    static_cast<void>(text.real("the reference of a face"));
  }
}

void skip_numbers(MeshText& text) {
  while (!text.at_end() && std::isalpha(static_cast<unsigned char>(text.peek().front())) == 0) {
    static_cast<void>(text.token("a number"));
  }
}

}  // namespace

VolumeBuilder parse_medit(const std::filesystem::path& file, std::string content, MeshNotes& notes) {
  if (content.starts_with(std::string_view("\1\0\0\0", 4)) || content.starts_with(std::string_view("\0\0\0\1", 4))) {
    return parse_binary_medit(file, content);
  }
  MeshText text(file, std::move(content), '#');
  VolumeBuilder builder(file);
  text.word("MeshVersionFormatted");
  skip_numbers(text);
  while (!text.at_end()) {
    const auto keyword = text.token("a keyword");
    if (same_word(keyword, "End")) {
      break;
    }
    if (same_word(keyword, "Dimension")) {
      static_cast<void>(text.integer("dimension 3", 3, 3));
    } else if (same_word(keyword, "Vertices")) {
      read_vertices(text, builder);
    } else if (same_word(keyword, "Tetrahedra")) {
      read_tetrahedra(text, builder);
    } else if (same_word(keyword, "Triangles")) {
      read_faces(text, 3, builder);
    } else if (same_word(keyword, "Quadrilaterals")) {
      read_faces(text, 4, builder);
    } else if (is_other_volume(keyword) && text.peek() != "0") {
      text.fail(keyword, "linear tetrahedra only");
    } else {
      skip_numbers(text);
    }
  }
  text.note_rest(notes, "section");
  return builder;
}

std::string format_medit(const TetrahedralMesh& mesh) {
  std::string text = "MeshVersionFormatted 2\nDimension 3\nVertices\n" + std::to_string(mesh.vertices.size()) + '\n';
  for (const auto& vertex : mesh.vertices) {
    append_point(text, vertex);
    text += " 0\n";
  }
  text += "Tetrahedra\n" + std::to_string(mesh.tetrahedra.size()) + '\n';
  for (const auto& tetrahedron : mesh.tetrahedra) {
    for (const int node : tetrahedron) {
      text += std::to_string(node + 1) + ' ';
    }
    text += "0\n";
  }
  return text + "End\n";
}

}  // namespace greenloop
