// Polygon File Format (Stanford): a text header that describes elements and their properties, then their values.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

#include "formats/mesh/binary_scalar.hpp"
#include "formats/mesh/surface_formats.hpp"

namespace greenloop {
namespace {

struct Property {
  std::string name;
  Scalar value;
  bool is_list = false;
  Scalar length = Scalar::u8;
};

struct Element {
  std::string name;
  std::size_t count = 0;
  std::vector<Property> properties;
};

Scalar read_type(MeshText& text) {
  struct Name {
    std::string_view word;
    Scalar type;
  };
  static constexpr std::array<Name, 16> names{{{"char", Scalar::i8},
                                               {"int8", Scalar::i8},
                                               {"uchar", Scalar::u8},
                                               {"uint8", Scalar::u8},
                                               {"short", Scalar::i16},
                                               {"int16", Scalar::i16},
                                               {"ushort", Scalar::u16},
                                               {"uint16", Scalar::u16},
                                               {"int", Scalar::i32},
                                               {"int32", Scalar::i32},
                                               {"uint", Scalar::u32},
                                               {"uint32", Scalar::u32},
                                               {"float", Scalar::f32},
                                               {"float32", Scalar::f32},
                                               {"double", Scalar::f64},
                                               {"float64", Scalar::f64}}};
  const auto word = text.token("a property type");
  const auto* const it = std::find_if(names.begin(), names.end(), [&](const Name& name) { return name.word == word; });
  if (it == names.end()) {
    text.fail(word, "a property type: char, uchar, short, ushort, int, uint, float or double");
  }
  return it->type;
}

Property read_property(MeshText& text) {
  Property property{};
  if (text.peek() == "list") {
    text.word("list");
    property.is_list = true;
    property.length = read_type(text);
  }
  property.value = read_type(text);
  property.name = text.token("a property name");
  return property;
}

enum class Encoding { ascii, little_endian, big_endian };

struct Header {
  Encoding encoding = Encoding::ascii;
  std::vector<Element> elements;
};

Encoding read_encoding(MeshText& text) {
  const auto format = text.token("a format");
  if (same_word(format, "ascii")) {
    return Encoding::ascii;
  }
  if (same_word(format, "binary_little_endian")) {
    return Encoding::little_endian;
  }
  if (!same_word(format, "binary_big_endian")) {
    text.fail(format, "format \"ascii\", \"binary_little_endian\" or \"binary_big_endian\"");
  }
  return Encoding::big_endian;
}

Header read_header(MeshText& text) {
  Header header;
  text.word("ply");
  text.word("format");
  header.encoding = read_encoding(text);
  text.skip_line();
  while (true) {
    const auto keyword = text.token("\"end_header\"");
    if (keyword == "element") {
      Element element;
      element.name = text.token("an element name");
      element.count = text.count("the number of elements", 1);
      header.elements.push_back(std::move(element));
    } else if (keyword == "property") {
      if (header.elements.empty()) {
        text.fail(keyword, "an element before its properties");
      }
      header.elements.back().properties.push_back(read_property(text));
    } else if (keyword != "comment" && keyword != "obj_info" && keyword != "end_header") {
      text.fail(keyword, "\"element\", \"property\", \"comment\" or \"end_header\"");
    }
    text.skip_line();
    if (keyword == "end_header") {
      return header;
    }
  }
}

/// Reads one value after the other, from text or from bytes.
class Values {
 public:
  Values(MeshText& text, const std::filesystem::path& file, Encoding encoding)
      : text_(text), file_(file), encoding_(encoding) {}

  double next(Scalar type) {
    return is_binary() ? decode(type, next_bytes(type), order()) : text_.real("a property value");
  }

  /// Passes over a value whatever it is.
  void skip(Scalar type) { static_cast<void>(is_binary() ? next_bytes(type) : text_.token("a property value").data()); }

  /// A value that has to be a whole number in [low, high].
  std::int64_t next_whole(Scalar type, std::string_view what, double low, double high) {
    const double value = next(type);
    if (!(value >= low && value <= high) || value != std::floor(value)) {
      std::string found;
      append_number(found, value);
      fail(found, std::string(what) + " (a whole number from " + std::to_string(static_cast<std::int64_t>(low)) +
                      " to " + std::to_string(static_cast<std::int64_t>(high)) + ")");
    }
    return static_cast<std::int64_t>(value);
  }

  [[nodiscard]] std::size_t bytes_left() const { return text_.rest().size(); }
  /// 0 in the binary part.
  [[nodiscard]] std::size_t line() const { return is_binary() ? 0 : text_.line_number(); }

  [[noreturn]] void fail(std::string_view found, std::string_view expected) const {
    if (!is_binary()) {
      text_.fail(found, expected);
    }
    throw MeshFileError(file_.string() + ": found " + std::string(found) + " in the binary part, expected " +
                        std::string(expected));
  }

 private:
  [[nodiscard]] std::endian order() const {
    return encoding_ == Encoding::big_endian ? std::endian::big : std::endian::little;
  }
  [[nodiscard]] bool is_binary() const { return encoding_ != Encoding::ascii; }

  const char* next_bytes(Scalar type) {
    const auto bytes = text_.rest();
    if (bytes.size() < size_of(type)) {
      fail("the end of the file", "a property value");
    }
    text_.skip_bytes(size_of(type));
    return bytes.data();
  }

  MeshText& text_;
  const std::filesystem::path& file_;
  Encoding encoding_;
};

std::size_t read_length(Values& values, const Property& property) {
  const auto most = static_cast<double>(values.bytes_left());
  return static_cast<std::size_t>(values.next_whole(property.length, "the length of a list", 0, most));
}

void skip_property(Values& values, const Property& property) {
  const std::size_t length = property.is_list ? read_length(values, property) : 1;
  for (std::size_t i = 0; i < length; ++i) {
    values.skip(property.value);
  }
}

void read_vertex(Values& values, const Element& element, PolygonMesh& mesh) {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  for (const auto& property : element.properties) {
    const auto axis = property.name.size() == 1 ? std::string_view("xyz").find(property.name[0]) : std::string::npos;
    if (axis == std::string_view::npos || property.is_list) {
      skip_property(values, property);
      continue;
    }
    const double value = values.next(property.value);
    if (!std::isfinite(value)) {
      values.fail("a coordinate that is not finite", "finite coordinates");
    }
    position[static_cast<Eigen::Index>(axis)] = value;
  }
  mesh.vertices.push_back(position);
}

bool is_polygon(const Property& property) {
  return property.is_list && (property.name == "vertex_indices" || property.name == "vertex_index");
}

std::size_t read_corner(Values& values, const Property& property, std::size_t vertex_count) {
  const double last = static_cast<double>(vertex_count) - 1;
  return static_cast<std::size_t>(values.next_whole(property.value, "a vertex index", 0, last));
}

void read_face(Values& values, const Property& property, std::size_t vertex_count, PolygonMesh& mesh,
               std::vector<int>& polygon) {
  const auto length = read_length(values, property);
  if (length < 3) {
    values.fail(std::to_string(length), "at least 3 vertices of a face");
  }
  polygon.clear();
  for (std::size_t i = 0; i < length; ++i) {
    polygon.push_back(static_cast<int>(read_corner(values, property, vertex_count)));
  }
  mesh.add(polygon, values.line());
}

/// Vertices of strips of triangles that turn in alternate senses; -1 ends a strip.
void read_strips(Values& values, const Property& property, std::size_t vertex_count, PolygonMesh& mesh) {
  const auto length = read_length(values, property);
  const double last = static_cast<double>(vertex_count) - 1;
  std::vector<int> strip;
  for (std::size_t i = 0; i < length; ++i) {
    const auto vertex = static_cast<int>(values.next_whole(property.value, "a vertex index or -1", -1, last));
    if (vertex < 0) {
      strip.clear();
      continue;
    }
    strip.push_back(vertex);
    if (strip.size() >= 3) {
      const std::size_t n = strip.size() - 3;
      mesh.add(n % 2 == 0 ? std::array{strip[n], strip[n + 1], strip[n + 2]}
                          : std::array{strip[n + 1], strip[n], strip[n + 2]},
               values.line());
    }
  }
}

bool holds_faces(const Element& element) { return element.name == "face" || element.name == "tristrips"; }

void read_element(Values& values, const Element& element, std::size_t vertex_count, PolygonMesh& mesh,
                  std::vector<int>& polygon) {
  if (element.name == "vertex") {
    read_vertex(values, element, mesh);
    return;
  }
  for (const auto& property : element.properties) {
    if (!holds_faces(element) || !is_polygon(property)) {
      skip_property(values, property);
    } else if (element.name == "face") {
      read_face(values, property, vertex_count, mesh, polygon);
    } else {
      read_strips(values, property, vertex_count, mesh);
    }
  }
}

void require_properties(const MeshText& text, const Element& element) {
  const auto has = [&](auto&& test) { return std::any_of(element.properties.begin(), element.properties.end(), test); };
  if (element.name == "vertex") {
    for (const std::string_view axis : {"x", "y", "z"}) {
      if (!has([&](const Property& p) { return p.name == axis && !p.is_list; })) {
        text.fail("element vertex without property " + std::string(axis), "properties x, y and z");
      }
    }
  }
  if (holds_faces(element) && !has(is_polygon)) {
    text.fail("element " + element.name + " without a list", "a list property vertex_indices");
  }
}

}  // namespace

PolygonMesh parse_ply(const std::filesystem::path& file, std::string content, MeshNotes& notes) {
  MeshText text(file, std::move(content), '\0');
  const auto header = read_header(text);
  std::size_t vertex_count = 0;
  for (const auto& element : header.elements) {
    require_properties(text, element);
    vertex_count += element.name == "vertex" ? element.count : 0;
  }
  Values values(text, file, header.encoding);
  PolygonMesh mesh;
  std::vector<int> polygon;
  for (const auto& element : header.elements) {
    for (std::size_t i = 0; i < element.count && !element.properties.empty(); ++i) {
      read_element(values, element, vertex_count, mesh, polygon);
    }
  }
  text.note_rest(notes, "element");
  return mesh;
}

std::string format_ply(const TriangleMesh& mesh) {
  std::string text = "ply\nformat ascii 1.0\nelement vertex " + std::to_string(mesh.vertices.size()) +
                     "\nproperty double x\nproperty double y\nproperty double z\nelement face " +
                     std::to_string(mesh.triangles.size()) + "\nproperty list uchar int vertex_indices\nend_header\n";
  append_corner_lists(text, mesh);
  return text;
}

}  // namespace greenloop
