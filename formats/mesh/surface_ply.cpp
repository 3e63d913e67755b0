// Polygon File Format (Stanford): a text header that describes elements and their properties, then their values.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <utility>
#include <vector>

#include "formats/mesh/surface_formats.hpp"

namespace greenloop {
namespace {

enum class Scalar { i8, u8, i16, u16, i32, u32, f32, f64 };

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

std::size_t size_of(Scalar type) {
  constexpr std::array<std::size_t, 8> sizes{1, 1, 2, 2, 4, 4, 4, 8};
  return sizes[static_cast<std::size_t>(type)];
}

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

struct Header {
  bool binary = false;
  std::vector<Element> elements;
};

Header read_header(MeshText& text) {
  Header header;
  text.word("ply");
  text.word("format");
  const auto format = text.token("a format");
  if (format != "ascii" && format != "binary_little_endian") {
    text.fail(format, "format \"ascii\" or \"binary_little_endian\"");
  }
  header.binary = format == "binary_little_endian";
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
  Values(MeshText& text, const std::filesystem::path& file, bool binary) : text_(text), file_(file), binary_(binary) {}

  double next(Scalar type) {
    if (!binary_) {
      return text_.real("a property value");
    }
    const auto bytes = text_.rest();
    if (bytes.size() < size_of(type)) {
      fail("the end of the file", "a property value");
    }
    const double value = decode(type, bytes.data());
    text_.skip_bytes(size_of(type));
    return value;
  }

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

  [[noreturn]] void fail(std::string_view found, std::string_view expected) const {
    if (!binary_) {
      text_.fail(found, expected);
    }
    throw MeshFileError(file_.string() + ": found " + std::string(found) + " in the binary part, expected " +
                        std::string(expected));
  }

 private:
  template <typename T>
  static double number(const char* bytes) {
    std::array<char, sizeof(T)> copy{};
    std::memcpy(copy.data(), bytes, sizeof(T));
    if constexpr (std::endian::native == std::endian::big) {
      std::reverse(copy.begin(), copy.end());
    }
    return static_cast<double>(std::bit_cast<T>(copy));
  }

  static double decode(Scalar type, const char* bytes) {
    switch (type) {
      case Scalar::i8:
        return number<std::int8_t>(bytes);
      case Scalar::u8:
        return number<std::uint8_t>(bytes);
      case Scalar::i16:
        return number<std::int16_t>(bytes);
      case Scalar::u16:
        return number<std::uint16_t>(bytes);
      case Scalar::i32:
        return number<std::int32_t>(bytes);
      case Scalar::u32:
        return number<std::uint32_t>(bytes);
      case Scalar::f32:
        return number<float>(bytes);
      case Scalar::f64:
        break;
    }
    return number<double>(bytes);
  }

  MeshText& text_;
  const std::filesystem::path& file_;
  bool binary_;
};

std::size_t read_length(Values& values, const Property& property) {
  const auto most = static_cast<double>(values.bytes_left());
  return static_cast<std::size_t>(values.next_whole(property.length, "the length of a list", 0, most));
}

void skip_property(Values& values, const Property& property) {
  const std::size_t length = property.is_list ? read_length(values, property) : 1;
  for (std::size_t i = 0; i < length; ++i) {
    static_cast<void>(values.next(property.value));
  }
}

void read_vertex(Values& values, const Element& element, TriangleMesh& mesh) {
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

void read_face(Values& values, const Element& element, TriangleMesh& mesh, std::vector<int>& polygon) {
  for (const auto& property : element.properties) {
    if (!is_polygon(property)) {
      skip_property(values, property);
      continue;
    }
    const auto length = read_length(values, property);
    if (length < 3) {
      values.fail(std::to_string(length), "at least 3 vertices of a face");
    }
    polygon.resize(length);
    for (int& vertex : polygon) {
      const double last = static_cast<double>(mesh.vertices.size()) - 1;
      vertex = static_cast<int>(values.next_whole(property.value, "a vertex index", 0, last));
    }
    append_fan(mesh, polygon);
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
  if (element.name == "face" && !has(is_polygon)) {
    text.fail("element face without a list", "a list property vertex_indices");
  }
}

}  // namespace

TriangleMesh parse_ply(const std::filesystem::path& file, std::string content) {
  MeshText text(file, std::move(content), '\0');
  const auto header = read_header(text);
  Values values(text, file, header.binary);
  TriangleMesh mesh;
  std::vector<int> polygon;
  for (const auto& element : header.elements) {
    require_properties(text, element);
    for (std::size_t i = 0; i < element.count && !element.properties.empty(); ++i) {
      if (element.name == "vertex") {
        read_vertex(values, element, mesh);
      } else if (element.name == "face") {
        read_face(values, element, mesh, polygon);
      } else {
        std::for_each(element.properties.begin(), element.properties.end(),
                      [&](const Property& property) { skip_property(values, property); });
      }
    }
  }
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
