// TetGen (.node and .ele beside each other) and Vega (.veg): numbered lists after a line of counts.
#include <utility>

#include "formats/mesh/volume_formats.hpp"

namespace greenloop {
namespace {

constexpr std::string_view nodes_per_element = "4 nodes per element (linear tetrahedra)";

/// "count dimension ...", then "number x y z ..." lines.
void read_nodes(MeshText& text, VolumeBuilder& builder) {
  const auto count = text.count("the number of nodes", 8);
  static_cast<void>(text.integer("dimension 3", 3, 3));
  text.skip_line();
  builder.reserve_nodes(count);
  for (std::size_t i = 0; i < count; ++i) {
    builder.read_node(text);
    text.skip_line();
  }
}

/// "count 4 ...", then "number a b c d ..." lines.
void read_elements(MeshText& text, VolumeBuilder& builder) {
  const auto count = text.count("the number of elements", 10);
  static_cast<void>(text.integer(nodes_per_element, 4, 4));
  text.skip_line();
  for (std::size_t i = 0; i < count; ++i) {
    static_cast<void>(read_number(text, "an element number"));
    builder.read_tetrahedron(text);
    text.skip_line();
  }
}

}  // namespace

std::filesystem::path tetgen_sibling(const std::filesystem::path& file) {
  const auto extension = file.extension().string();
  const bool upper = extension.size() > 1 && extension[1] >= 'A' && extension[1] <= 'Z';
  const bool nodes = lower_extension(file) == ".node";
  return std::filesystem::path(file).replace_extension(nodes ? (upper ? ".ELE" : ".ele") : (upper ? ".NODE" : ".node"));
}

VolumeBuilder parse_tetgen(const std::filesystem::path& file, std::string content, MeshNotes& notes) {
  auto node_file = file;
  auto element_file = tetgen_sibling(file);
  auto other_content = read_file(element_file);
  if (lower_extension(file) == ".ele") {
    node_file.swap(element_file);
    content.swap(other_content);
  }
  MeshText nodes(node_file, std::move(content), '#');
  MeshText elements(element_file, std::move(other_content), '#');
  VolumeBuilder builder(element_file);
  read_nodes(nodes, builder);
  nodes.note_rest(notes, "node");
  read_elements(elements, builder);
  elements.note_rest(notes, "element");
  return builder;
}

VolumeBuilder parse_vega(const std::filesystem::path& file, std::string content, MeshNotes& /*notes*/) {
  MeshText text(file, std::move(content), '#');
  VolumeBuilder builder(file);
  while (!text.at_end()) {
    const auto keyword = text.token("a keyword");
    if (same_word(keyword, "*VERTICES")) {
      read_nodes(text, builder);
    } else if (same_word(keyword, "*ELEMENTS")) {
      const auto type = text.token("an element type");
      if (!same_word(type, "TET") && !same_word(type, "TETS")) {
        text.fail(type, "\"TET\"");
      }
      read_elements(text, builder);
    } else if (same_word(keyword, "*INCLUDE")) {
      text.fail(keyword, "all lists in one file");
    } else {
      text.skip_line();
    }
  }
  return builder;
}

}  // namespace greenloop
