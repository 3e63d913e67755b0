// Gmsh MSH: version 1.0 ($NOD, $ELM), 2.x ($Nodes, $Elements) and 4.1 (the same in blocks of entities); from 2.x on
// also binary.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <span>
#include <string_view>
#include <utility>

#include "formats/mesh/binary_scalar.hpp"
#include "formats/mesh/volume_formats.hpp"

namespace greenloop {
namespace {

constexpr std::int64_t linear_tetrahedron = 4;

/// Nodes of points, lines and faces of any order, which are no volume; 0 for other elements.
std::size_t nodes_of_lower_dimensional(std::int64_t type) {
  constexpr std::array<std::array<std::int64_t, 2>, 17> types{{{1, 2},
                                                               {2, 3},
                                                               {3, 4},
                                                               {8, 3},
                                                               {9, 6},
                                                               {10, 9},
                                                               {15, 1},
                                                               {16, 8},
                                                               {20, 9},
                                                               {21, 10},
                                                               {22, 12},
                                                               {23, 15},
                                                               {24, 15},
                                                               {25, 21},
                                                               {26, 4},
                                                               {27, 5},
                                                               {28, 6}}};
  const auto* const it = std::find_if(types.begin(), types.end(), [&](const auto& t) { return t[0] == type; });
  return it == types.end() ? 0 : static_cast<std::size_t>((*it)[1]);
}

[[noreturn]] void refuse_element_type(const MeshText& text, std::int64_t type) {
  text.fail("element type " + std::to_string(type),
            "linear tetrahedra (type 4); second order, hexahedra, prisms and pyramids are not supported");
}

/// Of a tetrahedron, of a linear face, or of what can be skipped.
std::int64_t read_element_type(MeshText& text) {
  const auto type = read_number(text, "an element type");
  if (type != linear_tetrahedron && nodes_of_lower_dimensional(type) == 0) {
    refuse_element_type(text, type);
  }
  return type;
}

bool is_face(std::int64_t type) { return type == 2 || type == 3; }

template <typename Next>
void add_face(std::int64_t type, std::size_t line, const Next& next, VolumeBuilder& builder) {
  std::array<std::int64_t, 4> nodes{};
  const std::span corners(nodes.data(), nodes_of_lower_dimensional(type));
  std::generate(corners.begin(), corners.end(), next);
  builder.add_face(std::span<const std::int64_t>(corners), line);
}

void read_face(MeshText& text, std::int64_t type, VolumeBuilder& builder) {
  const auto line = text.line_number();
  add_face(
      type, line, [&] { return read_number(text, "the number of a node"); }, builder);
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
    const auto type = read_element_type(text);
    if (type == linear_tetrahedron || is_face(type)) {
      skip_numbers(text, version_1 ? 3 : text.integer("the number of tags", 0, 1000));
      type == linear_tetrahedron ? builder.read_tetrahedron(text) : read_face(text, type, builder);
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
    const auto type = read_element_type(text);
    const auto count = text.count("the number of elements of a block", 4);
    for (std::size_t i = 0; i < count; ++i) {
      skip_numbers(text, 1);
      if (type == linear_tetrahedron) builder.read_tetrahedron(text);
      if (is_face(type)) read_face(text, type, builder);
      text.skip_line();
    }
  }
}

/// Numbers of a binary file one after the other.
class GmshBytes {
 public:
  GmshBytes(MeshText& text, std::endian order) : text_(text), order_(order) {}

  std::int64_t next_int() { return decode_as<std::int32_t>(take(4), order_); }
  std::int64_t next_long() { return decode_as<std::int64_t>(take(8), order_); }
  Eigen::Vector3d next_point() {
    const auto next = [&] { return decode_as<double>(take(8), order_); };
    const double x = next(), y = next(), z = next();
    if (!std::isfinite(x) || !std::isfinite(y) || !std::isfinite(z)) {
      text_.fail("a coordinate that is not finite", "finite coordinates");
    }
    return {x, y, z};
  }
  void skip(std::size_t bytes) { static_cast<void>(text_.bytes(bytes, what)); }
  /// A number of items of at least so many bytes each, which have to be there.
  std::size_t count(std::int64_t value, std::size_t bytes_each) {
    if (value < 0 || static_cast<std::uint64_t>(value) > text_.rest().size() / bytes_each) {
      text_.fail(std::to_string(value) + " items", "a count that fits the bytes left in the file");
    }
    return static_cast<std::size_t>(value);
  }
  std::size_t next_count(std::size_t bytes_each) { return count(next_long(), bytes_each); }

  [[nodiscard]] const MeshText& text() const { return text_; }

 private:
  static constexpr std::string_view what = "a binary section";
  const char* take(std::size_t bytes) { return text_.bytes(bytes, what).data(); }

  MeshText& text_;
  std::endian order_;
};

template <typename Next>
void add_tetrahedron(const MeshText& text, const Next& next, VolumeBuilder& builder) {
  std::array<int, 4> nodes{};
  for (int& node : nodes) {
    const std::int64_t number = next();
    const auto index = builder.find_node(number);
    if (!index) {
      text.fail(std::to_string(number), "the number of one of the " + std::to_string(builder.node_count()) + " nodes");
    }
    node = *index;
  }
  builder.add_tetrahedron(nodes, 0);
}

/// Version 2: "number x y z", an int and three doubles.
void read_binary_nodes(MeshText& text, GmshBytes bytes, VolumeBuilder& builder) {
  const auto count = text.count("the number of nodes", 28);
  text.skip_line();
  builder.reserve_nodes(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto number = bytes.next_int();
    builder.add_node(text, number, bytes.next_point());
  }
}

/// Version 2, ints: "type count tag-count", then for each "number tags... nodes...".
void read_binary_elements(MeshText& text, GmshBytes bytes, VolumeBuilder& builder) {
  const auto count = text.count("the number of elements", 8);
  text.skip_line();
  for (std::size_t done = 0; done < count;) {
    const auto type = bytes.next_int();
    const auto block = bytes.count(bytes.next_int(), 8);
    const auto tags = bytes.count(bytes.next_int(), 1);
    const auto nodes = nodes_of_lower_dimensional(type);
    if (block == 0 || block > count - done) {
      text.fail("a block of " + std::to_string(block) + " elements", "one to " + std::to_string(count - done));
    }
    if (nodes == 0 && type != linear_tetrahedron) {
      refuse_element_type(text, type);
    }
    for (std::size_t i = 0; i < block; ++i) {
      const auto next = [&] { return bytes.next_int(); };
      bytes.skip(4 + 4 * tags + (is_face(type) ? 0 : 4 * nodes));
      if (type == linear_tetrahedron) add_tetrahedron(text, next, builder);
      if (is_face(type)) add_face(type, 0, next, builder);
    }
    done += block;
  }
}

/// Version 4.1: four longs, then blocks of "dimension entity parametric" (ints), a count (long), numbers, positions.
void read_binary_node_blocks(MeshText& text, GmshBytes bytes, VolumeBuilder& builder) {
  text.skip_line();
  const auto blocks = bytes.next_count(20);
  builder.reserve_nodes(bytes.next_count(32));
  bytes.skip(16);
  std::vector<std::int64_t> numbers;
  for (std::size_t block = 0; block < blocks; ++block) {
    const auto dimension = bytes.count(bytes.next_int(), 1);
    bytes.skip(4);
    const bool parametric = bytes.next_int() != 0;
    numbers.resize(bytes.next_count(32));
    std::generate(numbers.begin(), numbers.end(), [&] { return bytes.next_long(); });
    for (const auto number : numbers) {
      builder.add_node(text, number, bytes.next_point());
      bytes.skip(parametric ? 8 * std::min<std::size_t>(dimension, 3) : 0);
    }
  }
}

/// Version 4.1: four longs, then blocks of "dimension entity type" (ints), a count (long), for each number and nodes.
void read_binary_element_blocks(MeshText& text, GmshBytes bytes, VolumeBuilder& builder) {
  text.skip_line();
  const auto blocks = bytes.next_count(20);
  bytes.skip(24);
  for (std::size_t block = 0; block < blocks; ++block) {
    bytes.skip(8);
    const auto type = bytes.next_int();
    const auto nodes = nodes_of_lower_dimensional(type);
    if (nodes == 0 && type != linear_tetrahedron) {
      refuse_element_type(text, type);
    }
    const auto count = bytes.next_count(16);
    for (std::size_t i = 0; i < count; ++i) {
      const auto next = [&] { return bytes.next_long(); };
      bytes.skip(8 + (is_face(type) ? 0 : 8 * nodes));
      if (type == linear_tetrahedron) add_tetrahedron(text, next, builder);
      if (is_face(type)) add_face(type, 0, next, builder);
    }
  }
}

struct Format {
  bool version_4 = false;
  bool binary = false;
  std::endian order = std::endian::little;
};

Format read_format(MeshText& text) {
  Format format;
  const double version = text.real("a format version");
  if (!(version >= 2 && version < 3) && version != 4.1) {
    text.fail("version " + std::to_string(version), "version 2.2 or 4.1 (gmsh -format msh22 converts)");
  }
  format.version_4 = version == 4.1;
  format.binary = text.integer("the file type", 0, 1) != 0;
  static_cast<void>(text.integer("8 bytes a number", 8, 8));
  if (format.binary) {
    text.skip_line();
    const auto one = text.bytes(4, "the number 1");
    format.order =
        decode_as<std::int32_t>(one.data(), std::endian::little) == 1 ? std::endian::little : std::endian::big;
    if (decode_as<std::int32_t>(one.data(), format.order) != 1) {
      text.fail("other bytes", "the number 1 in binary");
    }
  }
  text.skip_line();
  return format;
}

void skip_section(MeshText& text, std::string_view end) {
  const auto at = text.rest().find(end);
  if (at != std::string_view::npos) {
    text.skip_bytes(at + end.size());
    return;
  }
  while (!text.at_end()) {
    text.skip_line();
  }
  static_cast<void>(text.token(in_quotes(end)));
}

void read_node_section(MeshText& text, const Format& format, VolumeBuilder& builder) {
  if (format.binary) {
    const GmshBytes bytes(text, format.order);
    format.version_4 ? read_binary_node_blocks(text, bytes, builder) : read_binary_nodes(text, bytes, builder);
  } else {
    format.version_4 ? read_node_blocks(text, builder) : read_nodes(text, builder);
  }
}

void read_element_section(MeshText& text, const Format& format, bool version_1, VolumeBuilder& builder) {
  if (format.binary) {
    const GmshBytes bytes(text, format.order);
    format.version_4 ? read_binary_element_blocks(text, bytes, builder) : read_binary_elements(text, bytes, builder);
  } else {
    format.version_4 ? read_element_blocks(text, builder) : read_elements(text, builder, version_1);
  }
}

}  // namespace

VolumeBuilder parse_gmsh(const std::filesystem::path& file, std::string content, MeshNotes& /*notes*/) {
  MeshText text(file, std::move(content), '\0');
  VolumeBuilder builder(file);
  Format format;
  while (!text.at_end()) {
    const auto section = text.token("a section");
    if (section.front() != '$') {
      text.fail(section, "a section such as $Nodes");
    }
    auto end = "$End" + std::string(section.substr(1));
    if (section == "$MeshFormat") {
      format = read_format(text);
    } else if (section == "$NOD" || section == "$Nodes") {
      read_node_section(text, format, builder);
    } else if (section == "$ELM" || section == "$Elements") {
      read_element_section(text, format, section == "$ELM", builder);
    } else {
      skip_section(text, end);
      continue;
    }
    if (section == "$NOD" || section == "$ELM") {
      end = section == "$NOD" ? "$ENDNOD" : "$ENDELM";
    }
    text.word(end);
  }
  return builder;
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
