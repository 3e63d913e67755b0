// VTK unstructured grids in XML (.vtu): arrays as text, base64 or raw appended bytes, plain or compressed by zlib.
#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "formats/mesh/volume_formats.hpp"
#include "formats/mesh/vtk_xml_array.hpp"

namespace greenloop {
namespace {

/// The value of name="value" in a tag.
std::optional<std::string_view> attribute(std::string_view tag, std::string_view name) {
  for (std::size_t at = tag.find(name); at != std::string_view::npos; at = tag.find(name, at + 1)) {
    const auto quote = at + name.size() + 1;
    const bool whole_word = at > 0 && (tag[at - 1] == ' ' || tag[at - 1] == '\n' || tag[at - 1] == '\t');
    if (whole_word && quote < tag.size() && tag[quote - 1] == '=' && (tag[quote] == '"' || tag[quote] == '\'')) {
      const auto end = tag.find(tag[quote], quote + 1);
      return end == std::string_view::npos ? std::nullopt : std::optional(tag.substr(quote + 1, end - quote - 1));
    }
  }
  return std::nullopt;
}

std::string_view name_of(std::string_view tag) { return tag.substr(0, tag.find_first_of(" \t\r\n/", 1)); }

/// The inside of the next <...> after skipping text and comments, "" at the end.
std::string_view next_tag(MeshText& text) {
  while (true) {
    const auto begin = text.rest().find('<');
    if (begin == std::string_view::npos) {
      return {};
    }
    text.skip_bytes(begin + 1);
    const bool comment = text.rest().starts_with("!--");
    const auto end = text.rest().find(comment ? "-->" : ">");
    if (end == std::string_view::npos) {
      text.fail(text.rest(), "the end of this tag");
    }
    const auto tag = text.rest().substr(0, end);
    text.skip_bytes(end + (comment ? 3 : 1));
    if (!comment && !tag.empty()) {
      return tag;
    }
  }
}

std::size_t count_attribute(const MeshText& text, std::string_view tag, std::string_view name) {
  const auto value = attribute(tag, name).value_or("");
  std::size_t count = 0;
  const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), count);
  if (error != std::errc{} || end != value.data() + value.size() || count > static_cast<std::size_t>(largest_index)) {
    text.fail(tag, std::string(name) + "=\"a count\"");
  }
  return count;
}

Scalar type_attribute(const MeshText& text, std::string_view tag, std::string_view name, std::string_view otherwise) {
  struct Name {
    std::string_view word;
    Scalar type;
  };
  static constexpr std::array<Name, 10> names{{{"Int8", Scalar::i8},
                                               {"UInt8", Scalar::u8},
                                               {"Int16", Scalar::i16},
                                               {"UInt16", Scalar::u16},
                                               {"Int32", Scalar::i32},
                                               {"UInt32", Scalar::u32},
                                               {"Int64", Scalar::i64},
                                               {"UInt64", Scalar::u64},
                                               {"Float32", Scalar::f32},
                                               {"Float64", Scalar::f64}}};
  const auto value = attribute(tag, name).value_or(otherwise);
  for (const auto& known : names) {
    if (known.word == value) {
      return known.type;
    }
  }
  text.fail(tag, std::string(name) + "=\"a type such as Float64 or Int64\"");
}

VtkEncoding read_encoding(const MeshText& text, std::string_view tag) {
  VtkEncoding encoding;
  if (attribute(tag, "type") != "UnstructuredGrid") {
    text.fail(tag, "a VTKFile of type UnstructuredGrid");
  }
  encoding.order = attribute(tag, "byte_order") == "BigEndian" ? std::endian::big : std::endian::little;
  encoding.header = type_attribute(text, tag, "header_type", "UInt32");
  if (encoding.header != Scalar::u32 && encoding.header != Scalar::u64) {
    text.fail(tag, "header_type=\"UInt32\" or \"UInt64\"");
  }
  const auto compressor = attribute(tag, "compressor").value_or("");
  encoding.compressed = !compressor.empty();
  if (encoding.compressed && compressor != "vtkZLibDataCompressor") {
    text.fail(compressor, "vtkZLibDataCompressor as the only compressor");
  }
  return encoding;
}

/// What stands behind the underscore of <AppendedData>.
struct Appended {
  bool base64 = false;
  std::string bytes;
};

/// Takes the appended data off the end of the file, whose bytes are no XML.
Appended take_appended(std::string& content) {
  Appended appended;
  const auto tag = content.find("<AppendedData");
  const auto begin = tag == std::string::npos ? tag : content.find('>', tag);
  const auto underscore = begin == std::string::npos ? begin : content.find('_', begin);
  if (underscore != std::string::npos) {
    appended.base64 = attribute(std::string_view(content).substr(tag, begin - tag), "encoding") == "base64";
    appended.bytes = content.substr(underscore + 1);
    content.resize(tag);
  }
  return appended;
}

/// One .vtu file.
class XmlGrid {
 public:
  XmlGrid(std::filesystem::path file, MeshText& text, const Appended& appended)
      : file_(std::move(file)), text_(text), appended_(appended), builder_(file_) {}

  VolumeBuilder read() {
    for (auto tag = next_tag(text_); !tag.empty(); tag = next_tag(text_)) {
      const auto name = name_of(tag);
      if (name == "VTKFile") {
        encoding_ = read_encoding(text_, tag);
      } else if (name == "Piece") {
        read_piece(tag);
      } else if (name == "Points" || name == "Cells") {
        section_ = name;
      } else if (name == "/Points" || name == "/Cells") {
        section_ = {};
      } else if (name == "DataArray" && !section_.empty()) {
        read_array(tag);
      }
    }
    add_cells();
    return std::move(builder_);
  }

 private:
  void read_piece(std::string_view tag) {
    if (pieces_++ > 0) {
      text_.fail(tag, "a single Piece");
    }
    points_ = count_attribute(text_, tag, "NumberOfPoints");
    cells_wanted_ = count_attribute(text_, tag, "NumberOfCells");
  }

  std::string unpack(std::string_view bytes, bool base64, const std::string& name) {
    const std::string decoded = base64 ? decode_base64(bytes) : std::string();
    return unpack_array(base64 ? decoded : bytes, encoding_, file_.string() + ": array " + in_quotes(name));
  }

  /// The bytes of a binary or appended array.
  std::string array_bytes(std::string_view tag, const std::string& name) {
    const auto format = attribute(tag, "format").value_or("ascii");
    if (format == "binary") {
      const auto inside = text_.rest();
      return unpack(inside.substr(0, inside.find('<')), true, name);
    }
    if (format != "appended") {
      text_.fail(tag, "format=\"ascii\", \"binary\" or \"appended\"");
    }
    const auto offset = count_attribute(text_, tag, "offset");
    if (offset >= appended_.bytes.size()) {
      text_.fail(tag, "an offset inside the AppendedData");
    }
    return unpack(std::string_view(appended_.bytes).substr(offset), appended_.base64, name);
  }

  /// Each array once; those that tell nothing about tetrahedra are left out.
  bool is_wanted(std::string_view tag, std::string_view name) {
    constexpr std::array<std::string_view, 4> names{"Points", "connectivity", "offsets", "types"};
    const auto* const known = std::find(names.begin(), names.end(), name);
    if (known == names.end()) {
      return false;
    }
    bool& seen = seen_[static_cast<std::size_t>(known - names.begin())];
    if (std::exchange(seen, true)) {
      text_.fail(tag, "this array once");
    }
    return true;
  }

  void read_array(std::string_view tag) {
    const std::string name(section_ == "Points" ? "Points" : attribute(tag, "Name").value_or(""));
    if (!is_wanted(tag, name)) {
      return;
    }
    if (attribute(tag, "format").value_or("ascii") == "ascii") {
      NumberArray numbers(text_);
      read_numbers(tag, name, numbers);
    } else {
      const auto type = type_attribute(text_, tag, "type", "");
      const auto bytes = array_bytes(tag, name);
      NumberArray numbers(file_, name, bytes, type, encoding_.order);
      read_numbers(tag, name, numbers);
    }
  }

  void read_numbers(std::string_view tag, std::string_view name, NumberArray& numbers) {
    if (name == "Points") {
      if (attribute(tag, "NumberOfComponents").value_or("") != "3") {
        text_.fail(tag, "NumberOfComponents=\"3\"");
      }
      for (std::size_t i = 0; i < points_; ++i) {
        builder_.add_node(text_, static_cast<std::int64_t>(i), numbers.point());
      }
    } else if (name == "connectivity") {
      while (numbers.more()) {
        cells_.read_point(numbers, builder_.node_count());
      }
    } else if (name == "offsets") {
      for (std::size_t i = 0; i < cells_wanted_; ++i) {
        cells_.read_offset(numbers);
      }
    } else if (name == "types") {
      for (std::size_t i = 0; i < cells_wanted_; ++i) {
        types_.push_back(static_cast<int>(numbers.integer("a cell type", 0, 255)));
      }
    }
  }

  void add_cells() {
    const NumberArray numbers(text_);
    if (cells_.size() != cells_wanted_ || types_.size() != cells_wanted_) {
      text_.fail(std::to_string(cells_.size()) + " cells of " + std::to_string(types_.size()) + " types",
                 "arrays connectivity, offsets and types of " + std::to_string(cells_wanted_) + " cells");
    }
    cells_.require_last_offset(numbers);
    for (std::size_t cell = 0; cell < cells_.size(); ++cell) {
      add_vtk_cell(numbers, cells_, cell, types_[cell], builder_);
    }
  }

  std::filesystem::path file_;
  MeshText& text_;
  const Appended& appended_;
  VolumeBuilder builder_;
  VtkEncoding encoding_;
  VtkCells cells_;
  std::vector<int> types_;
  std::array<bool, 4> seen_{};
  std::string_view section_;
  std::size_t points_ = 0;
  std::size_t cells_wanted_ = 0;
  int pieces_ = 0;
};

}  // namespace

VolumeBuilder parse_vtu(const std::filesystem::path& file, std::string content, MeshNotes& /*notes*/) {
  const Appended appended = take_appended(content);
  std::string spaced;  // a number may end where a tag begins
  spaced.reserve(content.size() + content.size() / 8);
  for (const char c : content) {
    spaced += c == '<' ? " <" : std::string_view(&c, 1);
  }
  content = std::move(spaced);
  MeshText text(file, std::move(content), '\0');
  return XmlGrid(file, text, appended).read();
}

}  // namespace greenloop
