// VTK unstructured grids, ascii: the legacy format (.vtk) and XML with inline data (.vtu).
#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <utility>

#include "formats/mesh/volume_formats.hpp"

namespace greenloop {
namespace {

constexpr std::int64_t linear_tetrahedron = 10;

/// Vertices, lines and faces: no volume.
bool is_lower_dimensional(std::int64_t type) { return (type >= 0 && type <= 9) || (type >= 21 && type <= 23); }

/// Points [offset(i), offset(i + 1)) of `points` are those of cell i.
struct Cells {
  std::vector<std::size_t> offsets{0};
  std::vector<int> points;
  std::vector<std::size_t> lines;  ///< one per point
};

class GridReader {
 public:
  GridReader(MeshText& text, VolumeBuilder& builder) : text_(text), builder_(builder) {}

  void read_points(std::size_t count) {
    builder_.reserve_nodes(count);
    for (std::size_t i = 0; i < count; ++i) {
      builder_.add_node(text_, static_cast<std::int64_t>(i), text_.point());
    }
  }

  void read_point_index() {
    const auto last = static_cast<std::int64_t>(builder_.node_count()) - 1;
    cells_.points.push_back(static_cast<int>(text_.integer("a point index", 0, last)));
    cells_.lines.push_back(text_.line_number());
  }

  /// "count a b c ..." for each cell.
  void read_counted_cells(std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      const auto points = text_.count("the number of points of a cell", 2);
      for (std::size_t j = 0; j < points; ++j) {
        read_point_index();
      }
      cells_.offsets.push_back(cells_.points.size());
    }
  }

  void read_connectivity(std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      read_point_index();
    }
  }

  /// The end of the next cell.
  void read_offset() {
    const auto low = static_cast<std::int64_t>(cells_.offsets.back());
    cells_.offsets.push_back(
        static_cast<std::size_t>(text_.integer("the offset where a cell ends", low, largest_index)));
  }

  /// A type for each cell; keeps the tetrahedra.
  void read_types() {
    if (cells_.offsets.back() != cells_.points.size()) {
      text_.fail(std::to_string(cells_.points.size()) + " point indices of cells",
                 std::to_string(cells_.offsets.back()) + " as the last offset says");
    }
    for (std::size_t cell = 0; cell + 1 < cells_.offsets.size(); ++cell) {
      const auto type = text_.integer("a cell type", 0, 255);
      if (type == linear_tetrahedron) {
        add_tetrahedron(cell);
      } else if (!is_lower_dimensional(type)) {
        text_.fail("cell type " + std::to_string(type), "linear tetrahedra (type 10) as the only volume cells");
      }
    }
  }

  [[nodiscard]] std::size_t cell_count() const { return cells_.offsets.size() - 1; }

 private:
  void add_tetrahedron(std::size_t cell) {
    const auto begin = cells_.offsets[cell];
    if (cells_.offsets[cell + 1] - begin != 4) {
      text_.fail("tetrahedron of " + std::to_string(cells_.offsets[cell + 1] - begin) + " points", "4 points");
    }
    const auto* points = cells_.points.data() + begin;
    builder_.add_tetrahedron({points[0], points[1], points[2], points[3]}, cells_.lines[begin]);
  }

  MeshText& text_;
  VolumeBuilder& builder_;
  Cells cells_;
};

/// CELLS of version 5: "CELLS offset-count point-count", OFFSETS type, the offsets, CONNECTIVITY type, the points.
void read_offset_cells(MeshText& text, GridReader& grid, std::size_t offset_count, std::size_t point_count) {
  text.word("OFFSETS");
  static_cast<void>(text.token("a data type"));
  static_cast<void>(text.integer("the first offset", 0, 0));
  for (std::size_t i = 1; i < offset_count; ++i) {
    grid.read_offset();
  }
  text.word("CONNECTIVITY");
  static_cast<void>(text.token("a data type"));
  grid.read_connectivity(point_count);
}

void read_legacy_cells(MeshText& text, GridReader& grid) {
  const auto count = text.count("the number of cells", 2);
  const auto size = text.count("the size of the cell list", 2);
  if (text.peek() == "OFFSETS") {
    read_offset_cells(text, grid, count, size);
  } else {
    grid.read_counted_cells(count);
  }
}

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

std::size_t count_attribute(const MeshText& text, std::string_view tag, std::string_view name, std::size_t bytes_each) {
  const auto value = attribute(tag, name).value_or("");
  std::size_t count = 0;
  const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), count);
  if (error != std::errc{} || end != value.data() + value.size() || count > text.rest().size() / bytes_each) {
    text.fail(tag, std::string(name) + "=\"a count that fits the file\"");
  }
  return count;
}

/// Reads one .vtu file; arrays in the order points, connectivity, offsets, types.
class XmlGrid {
 public:
  XmlGrid(MeshText& text, VolumeBuilder& builder) : text_(text), grid_(text, builder) {}

  void read() {
    for (auto tag = next_tag(text_); !tag.empty(); tag = next_tag(text_)) {
      const auto name = name_of(tag);
      if (name == "VTKFile" && attribute(tag, "type") != "UnstructuredGrid") {
        text_.fail(tag, "a VTKFile of type UnstructuredGrid");
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
  }

 private:
  void read_piece(std::string_view tag) {
    if (pieces_++ > 0) {
      text_.fail(tag, "a single Piece");
    }
    points_ = count_attribute(text_, tag, "NumberOfPoints", 6);
    cells_ = count_attribute(text_, tag, "NumberOfCells", 2);
  }

  void read_array(std::string_view tag) {
    if (attribute(tag, "format").value_or("") != "ascii") {
      text_.fail(tag, "format=\"ascii\"");
    }
    const auto name = attribute(tag, "Name").value_or("");
    if (section_ == "Points") {
      if (attribute(tag, "NumberOfComponents").value_or("") != "3") {
        text_.fail(tag, "NumberOfComponents=\"3\"");
      }
      grid_.read_points(points_);
    } else if (name == "connectivity") {
      while (!text_.at_end() && text_.peek().front() != '<') {
        grid_.read_point_index();
      }
    } else if (name == "offsets") {
      for (std::size_t i = 0; i < cells_; ++i) {
        grid_.read_offset();
      }
    } else if (name == "types") {
      if (grid_.cell_count() != cells_) {
        text_.fail(tag, "connectivity and offsets before types");
      }
      grid_.read_types();
    }
  }

  MeshText& text_;
  GridReader grid_;
  std::string_view section_;
  std::size_t points_ = 0;
  std::size_t cells_ = 0;
  int pieces_ = 0;
};

}  // namespace

TetrahedralMesh parse_vtk(const std::filesystem::path& file, std::string content) {
  MeshText text(file, std::move(content), '\0');
  const auto header = text.line();
  if (!header.starts_with("# vtk DataFile")) {
    text.fail(header, "\"# vtk DataFile Version\"");
  }
  text.skip_line();
  text.word("ASCII");
  text.word("DATASET");
  text.word("UNSTRUCTURED_GRID");
  VolumeBuilder builder(file);
  GridReader grid(text, builder);
  while (!text.at_end()) {
    const auto keyword = text.token("a keyword");
    if (keyword == "POINTS") {
      const auto count = text.count("the number of points", 6);
      static_cast<void>(text.token("a data type"));
      grid.read_points(count);
    } else if (keyword == "CELLS") {
      read_legacy_cells(text, grid);
    } else if (keyword == "CELL_TYPES") {
      if (text.count("the number of cells", 2) != grid.cell_count()) {
        text.fail("CELL_TYPES of another count", std::to_string(grid.cell_count()) + " cells");
      }
      grid.read_types();
      break;
    }
  }
  return builder.finish();
}

TetrahedralMesh parse_vtu(const std::filesystem::path& file, std::string content) {
  std::string spaced;  // a number may end where a tag begins
  spaced.reserve(content.size() + content.size() / 8);
  for (const char c : content) {
    spaced += c == '<' ? " <" : std::string_view(&c, 1);
  }
  content = std::move(spaced);
  MeshText text(file, std::move(content), '\0');
  VolumeBuilder builder(file);
  XmlGrid(text, builder).read();
  return builder.finish();
}

std::string format_vtk(const TetrahedralMesh& mesh) {
  const auto cells = std::to_string(mesh.tetrahedra.size());
  std::string text = "# vtk DataFile Version 3.0\ntetrahedra\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS " +
                     std::to_string(mesh.vertices.size()) + " double\n";
  for (const auto& vertex : mesh.vertices) {
    append_point(text, vertex);
    text += '\n';
  }
  text += "CELLS " + cells + ' ' + std::to_string(5 * mesh.tetrahedra.size()) + '\n';
  for (const auto& tetrahedron : mesh.tetrahedra) {
    text += '4';
    for (const int node : tetrahedron) {
      text += ' ' + std::to_string(node);
    }
    text += '\n';
  }
  text += "CELL_TYPES " + cells + '\n';
  for (std::size_t i = 0; i < mesh.tetrahedra.size(); ++i) {
    text += "10\n";
  }
  return text;
}

}  // namespace greenloop
