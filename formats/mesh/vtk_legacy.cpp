#include "formats/mesh/vtk_legacy.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace greenloop {

VtkLegacy::VtkLegacy(const std::filesystem::path& file, std::string content, std::string_view dataset)
    : file_(file), text_(file, std::move(content), '\0') {
  const auto header = text_.line();
  if (!header.starts_with("# vtk DataFile")) {
    text_.fail(header, "\"# vtk DataFile Version\"");
  }
  text_.skip_line();
  const auto encoding = text_.token("\"ASCII\" or \"BINARY\"");
  binary_ = same_word(encoding, "BINARY");
  if (!binary_ && !same_word(encoding, "ASCII")) {
    text_.fail(encoding, "\"ASCII\" or \"BINARY\"");
  }
  text_.word("DATASET");
  text_.word(dataset);
}

Scalar VtkLegacy::read_type() {
  struct Name {
    std::string_view word;
    Scalar type;
  };
  static constexpr std::array<Name, 13> names{{{"char", Scalar::i8},
                                               {"unsigned_char", Scalar::u8},
                                               {"short", Scalar::i16},
                                               {"unsigned_short", Scalar::u16},
                                               {"int", Scalar::i32},
                                               {"vtkIdType", Scalar::i32},
                                               {"unsigned_int", Scalar::u32},
                                               {"long", Scalar::i64},
                                               {"vtktypeint64", Scalar::i64},
                                               {"unsigned_long", Scalar::u64},
                                               {"vtktypeuint64", Scalar::u64},
                                               {"float", Scalar::f32},
                                               {"double", Scalar::f64}}};
  const auto word = text_.token("a data type");
  const auto* const it =
      std::find_if(names.begin(), names.end(), [&](const Name& name) { return same_word(name.word, word); });
  if (it == names.end()) {
    text_.fail(word, "a data type such as int, vtktypeint64, float or double");
  }
  return it->type;
}

NumberArray VtkLegacy::numbers(Scalar type, std::size_t count) {
  if (!binary_) {
    return NumberArray(text_);
  }
  text_.skip_line();
  const auto line = std::to_string(text_.line_number());
  const auto bytes = text_.bytes(count * size_of(type), "numbers");
  return {file_, "behind line " + line, bytes, type, std::endian::big};
}

std::vector<Eigen::Vector3d> VtkLegacy::read_points() {
  const auto count = text_.count("the number of points", 3);
  const auto type = read_type();
  auto values = numbers(type, 3 * count);
  std::vector<Eigen::Vector3d> points(count);
  std::generate(points.begin(), points.end(), [&] { return values.point(); });
  return points;
}

/// "count a b c ..." for each cell.
void VtkLegacy::read_counted_cells(std::size_t count, std::size_t size, std::size_t point_count, VtkCells& cells) {
  auto values = numbers(Scalar::i32, size);
  for (std::size_t i = 0; i < count; ++i) {
    const auto points = values.integer("the number of points of a cell", 0, static_cast<std::int64_t>(size));
    for (std::int64_t j = 0; j < points; ++j) {
      cells.read_point(values, point_count);
    }
    cells.offsets.push_back(cells.points.size());
  }
}

/// Version 5: OFFSETS type, the offsets, CONNECTIVITY type, the points.
void VtkLegacy::read_offset_cells(std::size_t offset_count, std::size_t size, std::size_t point_count,
                                  VtkCells& cells) {
  text_.word("OFFSETS");
  const auto offset_type = read_type();
  auto offsets = numbers(offset_type, offset_count);
  if (offset_count > 0) {
    static_cast<void>(offsets.integer("the first offset", 0, 0));
  }
  for (std::size_t i = 1; i < offset_count; ++i) {
    cells.read_offset(offsets);
  }
  text_.word("CONNECTIVITY");
  const auto point_type = read_type();
  auto points = numbers(point_type, size);
  for (std::size_t i = 0; i < size; ++i) {
    cells.read_point(points, point_count);
  }
  cells.require_last_offset(points);
}

VtkCells VtkLegacy::read_cells(std::size_t point_count) {
  const auto count = text_.count("the number of cells", 1);
  const auto size = text_.count("the size of the cell list", 1);
  VtkCells cells;
  // in a binary file of the older form numbers begin right behind this line
  const auto next = text_.rest().substr(std::min(text_.rest().find_first_not_of(" \t\r\n"), text_.rest().size()));
  const bool begins_offsets = next.starts_with("OFFSETS");
  begins_offsets ? read_offset_cells(count, size, point_count, cells)
                 : read_counted_cells(count, size, point_count, cells);
  return cells;
}

/// "FIELD name count", then for each array "name components tuples type" and its values.
void VtkLegacy::skip_field() {
  static_cast<void>(text_.token("a name"));
  const auto arrays = text_.count("the number of arrays", 1);
  for (std::size_t i = 0; i < arrays; ++i) {
    static_cast<void>(text_.token("the name of an array"));
    const auto components = text_.count("the number of components", 1);
    const auto tuples = text_.count("the number of tuples", 1);
    if (components > 0 && tuples > text_.rest().size() / components) {
      text_.fail(std::to_string(tuples), "a number of tuples that fits the file");
    }
    const auto type = read_type();
    auto values = numbers(type, components * tuples);
    for (std::size_t j = 0; j < components * tuples && !binary_; ++j) {
      static_cast<void>(text_.token("a value"));
    }
    while (text_.peek() == "METADATA") {
      static_cast<void>(skip_part(text_.token("METADATA")));
    }
  }
}

bool VtkLegacy::skip_part(std::string_view keyword) {
  if (same_word(keyword, "FIELD")) {
    skip_field();
    return true;
  }
  if (!same_word(keyword, "METADATA")) {
    return false;
  }
  text_.skip_line();  // text, up to an empty line
  while (!text_.rest().empty() && !text_.line().empty()) {
  }
  return true;
}

}  // namespace greenloop
