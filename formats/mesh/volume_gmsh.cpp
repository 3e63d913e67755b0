// Gmsh MSH, ascii: version 1.0 ($NOD, $ELM), 2.x ($Nodes, $Elements) and 4.1 (the same in blocks of entities).
#include <algorithm>
#include <array>
#include <utility>

#include "formats/mesh/volume_formats.hpp"

namespace greenloop {
namespace {

constexpr std::int64_t linear_tetrahedron = 4;

/// Points, lines and faces of any order: no volume.
bool is_lower_dimensional(std::int64_t type) {
  constexpr std::array<std::int64_t, 17> types{1, 2, 3, 8, 9, 10, 15, 16, 20, 21, 22, 23, 24, 25, 26, 27, 28};
  return std::find(types.begin(), types.end(), type) != types.end();
}

/// True for a tetrahedron, false for what can be skipped.
bool read_element_type(MeshText& text) {
  const auto type = read_number(text, "an element type");
  if (type != linear_tetrahedron && !is_lower_dimensional(type)) {
    text.fail("element type " + std::to_string(type),
              "linear tetrahedra (type 4); second order, hexahedra, prisms and pyramids are not supported");
  }
  return type == linear_tetrahedron;
}

void skip_numbers(MeshText& text, std::int64_t count) {
  for (std::int64_t i = 0; i < count; ++i) {
    static_cast<void>(read_number(text, "a tag"));
  }
}

void read_nodes(MeshText& text, VolumeBuilder& builder) {
  const auto count = text.count("the number of nodes", 8);
  builder.reserve_nodes(count);
  for (std::size_t i = 0; i < count; ++i) {
    builder.read_node(text);
  }
}

/// "number type tag-count tags... nodes..."; version 1: "number type physical entity node-count nodes...".
void read_elements(MeshText& text, VolumeBuilder& builder, bool version_1) {
  const auto count = text.count("the number of elements", 6);
  for (std::size_t i = 0; i < count; ++i) {
    skip_numbers(text, 1);
    if (read_element_type(text)) {
      skip_numbers(text, version_1 ? 3 : text.integer("the number of tags", 0, 1000));
      builder.read_tetrahedron(text);
    }
    text.skip_line();
  }
}

void read_node_blocks(MeshText& text, VolumeBuilder& builder) {
  const auto blocks = text.count("the number of blocks of nodes", 8);
  builder.reserve_nodes(text.count("the number of nodes", 8));
  skip_numbers(text, 2);
  std::vector<std::int64_t> numbers;
  for (std::size_t block = 0; block < blocks; ++block) {
    skip_numbers(text, 3);
    numbers.resize(text.count("the number of nodes of a block", 8));
    std::generate(numbers.begin(), numbers.end(), [&] { return read_number(text, "a node number"); });
    for (const auto number : numbers) {
      builder.add_node(text, number, text.point());
      text.skip_line();
    }
  }
}

void read_element_blocks(MeshText& text, VolumeBuilder& builder) {
  const auto blocks = text.count("the number of blocks of elements", 8);
  skip_numbers(text, 3);
  for (std::size_t block = 0; block < blocks; ++block) {
    skip_numbers(text, 2);
    const bool tetrahedra = read_element_type(text);
    const auto count = text.count("the number of elements of a block", 4);
    for (std::size_t i = 0; i < count; ++i) {
      skip_numbers(text, 1);
      if (tetrahedra) {
        builder.read_tetrahedron(text);
      }
      text.skip_line();
    }
  }
}

/// True for version 4.1, false for 2.x.
bool read_format(MeshText& text) {
  const double version = text.real("a format version");
  if (!(version >= 2 && version < 3) && version != 4.1) {
    text.fail("version " + std::to_string(version), "version 2.2 or 4.1 (gmsh -format msh22 converts)");
  }
  if (text.integer("the file type", 0, 1) != 0) {
    text.fail("a binary file", "an ascii one (file type 0)");
  }
  text.skip_line();
  return version == 4.1;
}

void skip_section(MeshText& text, const std::string& end) {
  while (!text.at_end()) {
    if (text.line() == end) {
      return;
    }
  }
  static_cast<void>(text.token(in_quotes(end)));
}

}  // namespace

TetrahedralMesh parse_gmsh(const std::filesystem::path& file, std::string content) {
  MeshText text(file, std::move(content), '\0');
  VolumeBuilder builder(file);
  bool version_4 = false;
  while (!text.at_end()) {
    const auto section = text.token("a section");
    if (section.front() != '$') {
      text.fail(section, "a section such as $Nodes");
    }
    auto end = "$End" + std::string(section.substr(1));
    if (section == "$MeshFormat") {
      version_4 = read_format(text);
    } else if (section == "$NOD" || section == "$Nodes") {
      version_4 ? read_node_blocks(text, builder) : read_nodes(text, builder);
    } else if (section == "$ELM" || section == "$Elements") {
      version_4 ? read_element_blocks(text, builder) : read_elements(text, builder, section == "$ELM");
    } else {
      skip_section(text, end);
      continue;
    }
    if (section == "$NOD" || section == "$ELM") {
      end = section == "$NOD" ? "$ENDNOD" : "$ENDELM";
    }
    text.word(end);
  }
  return builder.finish();
}

std::string format_gmsh(const TetrahedralMesh& mesh) {
  std::string text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n" + std::to_string(mesh.vertices.size()) + '\n';
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    text += std::to_string(i + 1) + ' ';
    append_point(text, mesh.vertices[i]);
    text += '\n';
  }
  text += "$EndNodes\n$Elements\n" + std::to_string(mesh.tetrahedra.size()) + '\n';
  for (std::size_t i = 0; i < mesh.tetrahedra.size(); ++i) {
    text += std::to_string(i + 1) + " 4 2 0 1";
    for (const int node : mesh.tetrahedra[i]) {
      text += ' ' + std::to_string(node + 1);
    }
    text += '\n';
  }
  return text + "$EndElements\n";
}

}  // namespace greenloop
