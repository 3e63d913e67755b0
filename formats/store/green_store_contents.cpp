#include "formats/store/green_store_contents.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <stdexcept>
#include <type_traits>
#include <utility>

#include "formats/layout.hpp"
#include "formats/verify/crc32c.hpp"

namespace greenloop {
namespace {

// a byte of the file each
constexpr std::uint32_t all_flags =
    layout::node_domain | layout::node_touchable | layout::node_fixed | layout::node_read;

constexpr const char* kQuadratic = "quadratic";

[[noreturn]] void reject(const std::string& what) { throw std::invalid_argument("Green's function store: " + what); }

void require_count(const std::string& field, std::size_t found, std::size_t expected) {
  if (found != expected) {
    reject(field + " has " + std::to_string(found) + " entries, it needs " + std::to_string(expected));
  }
}

template <std::size_t Width>
void require_indices(const std::string& field, const std::vector<std::array<int, Width>>& rows, std::size_t end) {
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (const int index : rows[r]) {
      if (index < 0 || static_cast<std::size_t>(index) >= end) {
        reject(field + "[" + std::to_string(r) + "] names vertex " + std::to_string(index) + " of " +
               std::to_string(end));
      }
    }
  }
}

void require_finite(const std::string& field, const std::vector<Eigen::Vector3d>& points) {
  for (std::size_t p = 0; p < points.size(); ++p) {
    if (!points[p].allFinite()) reject(field + "[" + std::to_string(p) + "] is not finite");
  }
}

void require_nodes(const std::string& field, const std::vector<int>& nodes, std::size_t end) {
  if (nodes.empty()) reject(field + " is empty; at least one node is needed");
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const bool increasing = k == 0 ? nodes[k] >= 0 : nodes[k] > nodes[k - 1];
    if (!increasing || static_cast<std::size_t>(nodes[k]) >= end) {
      reject(field + "[" + std::to_string(k) + "] = " + std::to_string(nodes[k]) +
             "; surface vertices in strictly increasing order are wanted, each below " + std::to_string(end));
    }
  }
}

void require_levels(const SemiRegularMesh& surface) {
  const std::size_t count = surface.positions.size();
  require_count("/surface/parents", surface.parents.size(), count);
  const auto& end = surface.vertex_end;
  if (end.empty() || end.front() == 0 || !std::is_sorted(end.begin(), end.end()) || end.back() != count) {
    reject("/surface/vertex_end must increase and end with the number of vertices, " + std::to_string(count));
  }
  for (std::size_t v = 0; v < count; ++v) {
    const auto [a, b] = surface.parents[v];
    const bool base = v < end.front();
    const bool valid = base ? a == -1 && b == -1 : a >= 0 && a < b && static_cast<std::size_t>(b) < v;
    if (!valid) {
      reject("/surface/parents[" + std::to_string(v) + "] = (" + std::to_string(a) + ", " + std::to_string(b) +
             ") is wrong: base vertices have (-1, -1), others two earlier vertices, the smaller first");
    }
  }
}

void require_valid_surface(const GreenStoreContents& contents) {
  const std::size_t count = contents.surface.positions.size();
  if (count == 0) reject("/surface/position is empty");
  require_finite("/surface/position", contents.surface.positions);
  require_levels(contents.surface);
  require_indices("/surface/base_triangles", contents.surface.base_triangles, contents.surface.vertex_end.front());
  require_count("/surface/area", contents.area.size(), count);
  require_count("/surface/flags", contents.flags.size(), count);
  for (std::size_t v = 0; v < count; ++v) {
    if (!(contents.area[v] > 0.0) || !std::isfinite(contents.area[v])) {
      reject("/surface/area[" + std::to_string(v) + "] = " + std::to_string(contents.area[v]) + " must be positive");
    }
    if (contents.flags[v] > all_flags) {
      reject("/surface/flags[" + std::to_string(v) + "] = " + std::to_string(contents.flags[v]) +
             " is not a sum of 1 free, 2 touchable, 4 fixed, 8 read");
    }
  }
}

void require_valid_volume(const GreenStoreContents& contents) {
  const auto& volume = contents.volume;
  require_count("/volume/fixed", contents.volume_fixed.size(), volume.vertices.size());
  require_finite("/volume/position", volume.vertices);
  require_indices("/volume/tetrahedra", volume.tetrahedra, volume.vertices.size());
  if (volume.vertices.empty()) return;
  require_count("/volume/interpolation rows", static_cast<std::size_t>(contents.interpolation.rows()),
                contents.surface.positions.size());
  require_count("/volume/interpolation columns", static_cast<std::size_t>(contents.interpolation.cols()),
                volume.vertices.size());
}

void require_valid_elastic(const GreenStoreContents& contents) {
  if (contents.components != 3) {
    reject("there are " + std::to_string(contents.components) + " components; 3 are wanted, or 1 of a scalar problem");
  }
  if (contents.unit != "m/N") reject("the unit of 3 components is m/N, not '" + contents.unit + "'");
  if (!(contents.young > 0.0) || !std::isfinite(contents.young)) reject("young must be positive, in Pa");
  if (!(contents.poisson > -1.0 && contents.poisson < 0.5)) reject("poisson must lie between -1 and 0.5");
}

void require_valid_scalar(const GreenStoreContents& contents) {
  if (contents.unit.empty()) reject("the unit of a scalar problem's columns is empty; name it, as in K/W");
  if (contents.young != 0.0 || contents.poisson != 0.0) reject("young and poisson of a scalar problem must be 0");
}

// by the shape of the columns: what is of neither is refused as a store of 3
int stored_components(const Hdf5File& file) {
  const Hdf5Shape shape = file.shape(kDisplacement);
  return shape.size() == 4 && shape[1] == 1 && shape[3] == 1 ? 1 : 3;
}

void write_material(Hdf5File& file, const GreenStoreContents& contents) {
  file.write_number("/", "young", contents.young);
  file.write_text("/", "young_unit", "Pa");
  file.write_number("/", "poisson", contents.poisson);
  if (contents.elements == Elements::quadratic) file.write_text("/", "elements", kQuadratic);
}

void read_material(const Hdf5File& file, GreenStoreContents& contents) {
  contents.young = file.read_number("/", "young");
  if (file.read_text("/", "young_unit") != "Pa") file.fail("/", "young_unit must be 'Pa'");
  contents.poisson = file.read_number("/", "poisson");
  if (!file.has_attribute("/", "elements")) return;
  if (file.read_text("/", "elements") != kQuadratic) file.fail("/", "elements must be 'quadratic', or absent");
  contents.elements = Elements::quadratic;
}

std::vector<double> flat(const std::vector<Eigen::Vector3d>& points) {
  std::vector<double> values;
  values.reserve(3 * points.size());
  for (const auto& x : points) values.insert(values.end(), {x.x(), x.y(), x.z()});
  return values;
}

template <std::size_t Width>
std::vector<int> flat(const std::vector<std::array<int, Width>>& rows) {
  std::vector<int> values;
  values.reserve(Width * rows.size());
  for (const auto& row : rows) values.insert(values.end(), row.begin(), row.end());
  return values;
}

void write_points(Hdf5File& file, const std::string& dataset, const std::vector<Eigen::Vector3d>& points) {
  file.write(dataset, {points.size(), 3}, flat(points));
  file.write_text(dataset, "unit", "m");
}

template <std::size_t Width>
void write_rows(Hdf5File& file, const std::string& dataset, const std::vector<std::array<int, Width>>& rows) {
  file.write(dataset, {rows.size(), Width}, flat(rows));
}

template <typename Number>
void write_list(Hdf5File& file, const std::string& dataset, const std::vector<Number>& values) {
  file.write(dataset, {values.size()}, values);
}

// A shape before its numbers: `any` stands for a length that nothing else says.
constexpr hsize_t any = ~hsize_t{0};

Hdf5Shape require_shape(const Hdf5File& file, const std::string& dataset, const Hdf5Shape& expected) {
  const Hdf5Shape found = file.shape(dataset);
  if (found.size() != expected.size()) {
    file.fail(dataset, expected.size() == 1 ? "must have one axis"
                                            : "must have the shape [count, " + std::to_string(expected[1]) + "]");
  }
  for (std::size_t axis = 0; axis < found.size(); ++axis) {
    if (expected[axis] == any || found[axis] == expected[axis]) continue;
    file.fail(dataset, axis == 0 ? "has " + std::to_string(found[0]) + " entries, it needs " +
                                       std::to_string(expected[0]) + " entries"
                                 : "must have the shape [count, " + std::to_string(expected[1]) + "]");
  }
  return found;
}

template <typename Number>
std::vector<Number> read_list(const Hdf5File& file, const std::string& dataset, hsize_t count) {
  Hdf5Shape shape = require_shape(file, dataset, {count});
  return file.read<Number>(dataset, shape);
}

template <typename Number>
std::vector<Number> read_table(const Hdf5File& file, const std::string& dataset, hsize_t count, hsize_t width) {
  Hdf5Shape shape = require_shape(file, dataset, {count, width});
  return file.read<Number>(dataset, shape);
}

std::vector<Eigen::Vector3d> read_points(const Hdf5File& file, const std::string& dataset) {
  require_unit(file, dataset, "m");
  const auto values = read_table<double>(file, dataset, any, 3);
  std::vector<Eigen::Vector3d> points;
  points.reserve(values.size() / 3);
  for (std::size_t k = 0; k < values.size(); k += 3) points.emplace_back(values[k], values[k + 1], values[k + 2]);
  return points;
}

template <std::size_t Width>
std::vector<std::array<int, Width>> read_rows(const Hdf5File& file, const std::string& dataset, hsize_t count) {
  const auto values = read_table<int>(file, dataset, count, Width);
  std::vector<std::array<int, Width>> rows(values.size() / Width);
  for (std::size_t k = 0; k < values.size(); ++k) rows[k / Width][k % Width] = values[k];
  return rows;
}

using Interpolation = Eigen::SparseMatrix<double, Eigen::RowMajor>;

void write_interpolation(Hdf5File& file, Interpolation matrix) {
  matrix.makeCompressed();
  const auto* start = matrix.outerIndexPtr();
  const auto* column = matrix.innerIndexPtr();
  const auto* weight = matrix.valuePtr();
  file.make_group("/volume/interpolation");
  write_list(file, "/volume/interpolation/row_start", std::vector<int>(start, start + matrix.rows() + 1));
  write_list(file, "/volume/interpolation/column", std::vector<int>(column, column + matrix.nonZeros()));
  write_list(file, "/volume/interpolation/weight", std::vector<double>(weight, weight + matrix.nonZeros()));
}

Interpolation read_interpolation(const Hdf5File& file, std::size_t rows, std::size_t columns) {
  const std::string group = "/volume/interpolation";
  const auto start = read_list<int>(file, group + "/row_start", rows + 1);
  if (start.front() != 0 || !std::is_sorted(start.begin(), start.end())) {
    file.fail(group + "/row_start", "must rise from 0");
  }
  const auto entries_in_all = static_cast<hsize_t>(start.back());
  const auto column = read_list<int>(file, group + "/column", entries_in_all);
  const auto weight = read_list<double>(file, group + "/weight", entries_in_all);
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t r = 0; r < rows; ++r) {
    for (int k = start[r]; k < start[r + 1]; ++k) {
      if (column[k] < 0 || static_cast<std::size_t>(column[k]) >= columns || !std::isfinite(weight[k])) {
        file.fail(group, "entry " + std::to_string(k) + " is out of range");
      }
      entries.emplace_back(static_cast<int>(r), column[k], weight[k]);
    }
  }
  Interpolation matrix(static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(columns));
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

SemiRegularMesh read_surface(const Hdf5File& file) {
  SemiRegularMesh surface;
  surface.positions = read_points(file, "/surface/position");
  surface.parents = read_rows<2>(file, "/surface/parents", surface.positions.size());
  surface.base_triangles = read_rows<3>(file, "/surface/base_triangles", any);
  for (const int end : read_list<int>(file, "/surface/vertex_end", any)) {
    if (end < 0) file.fail("/surface/vertex_end", "must not be negative");
    surface.vertex_end.push_back(static_cast<std::size_t>(end));
  }
  return surface;
}

}  // namespace

void require_unit(const Hdf5File& file, const std::string& dataset, const std::string& unit) {
  const auto found = file.read_text(dataset, "unit");
  if (found != unit) file.fail(dataset, "its unit is '" + found + "', convert it to '" + unit + "'");
}

void require_valid(const GreenStoreContents& contents) {
  require_valid_surface(contents);
  require_valid_volume(contents);
  require_nodes("/green/row_node", contents.row_node, contents.surface.positions.size());
  require_nodes("/green/column_node", contents.column_node, contents.surface.positions.size());
  contents.components == 1 ? require_valid_scalar(contents) : require_valid_elastic(contents);
}

void write_contents(Hdf5File& file, const GreenStoreContents& contents) {
  file.write_text("/", "format", "greenloop store");
  file.write_number("/", "format_version", kGreenStoreVersion);
  if (contents.components == 3) write_material(file, contents);
  file.write_text("/", "provenance", contents.provenance);
  file.write_text("/", "fingerprint", contents.fingerprint);
  file.write_number("/", kContentsChecksum, checksum(contents));
  for (const char* group : {"/surface", "/green", "/volume"}) file.make_group(group);

  write_points(file, "/surface/position", contents.surface.positions);
  write_rows(file, "/surface/parents", contents.surface.parents);
  write_rows(file, "/surface/base_triangles", contents.surface.base_triangles);
  write_list(file, "/surface/vertex_end",
             std::vector<int>(contents.surface.vertex_end.begin(), contents.surface.vertex_end.end()));
  write_list(file, "/surface/area", contents.area);
  file.write_text("/surface/area", "unit", "m^2");
  write_list(file, "/surface/flags", std::vector<unsigned char>(contents.flags.begin(), contents.flags.end()));
  file.write_text("/surface/flags", "bits", "1 free, 2 touchable, 4 fixed, 8 read");
  write_list(file, "/green/row_node", contents.row_node);
  write_list(file, "/green/column_node", contents.column_node);
  if (contents.volume.vertices.empty()) return;
  write_points(file, "/volume/position", contents.volume.vertices);
  write_rows(file, "/volume/tetrahedra", contents.volume.tetrahedra);
  write_list(file, "/volume/fixed", contents.volume_fixed);
  write_interpolation(file, contents.interpolation);
}

GreenStoreContents read_contents(const Hdf5File& file) {
  if (file.read_text("/", "format") != "greenloop store") file.fail("/", "the attribute 'format' names another format");
  const double version = file.read_number("/", "format_version");
  if (version == 1) {
    file.fail("/",
              "format_version 1 has no checksums: columns that were lost on their way to the disk cannot be told "
              "from solved ones; build the store again (greenloop build --overwrite-store)");
  }
  if (version != kGreenStoreVersion) {
    file.fail("/", "format_version " + std::to_string(version) + " is not " + std::to_string(kGreenStoreVersion) +
                       "; build the store again with this version of Greenloop");
  }
  GreenStoreContents contents;
  contents.components = stored_components(file);
  if (contents.components == 3) {
    read_material(file, contents);
  } else {
    contents.unit = file.read_text(kDisplacement, "unit");
  }
  contents.provenance = file.read_text("/", "provenance");
  contents.fingerprint = file.read_text("/", "fingerprint");
  contents.surface = read_surface(file);
  const hsize_t surface_count = contents.surface.positions.size();
  require_unit(file, "/surface/area", "m^2");
  contents.area = read_list<double>(file, "/surface/area", surface_count);
  const auto flags = read_list<unsigned char>(file, "/surface/flags", surface_count);
  contents.flags.assign(flags.begin(), flags.end());
  contents.row_node = read_list<int>(file, "/green/row_node", any);
  contents.column_node = read_list<int>(file, "/green/column_node", any);
  if (file.has("/volume/position")) {
    contents.volume.vertices = read_points(file, "/volume/position");
    contents.volume.tetrahedra = read_rows<4>(file, "/volume/tetrahedra", any);
    contents.volume_fixed = read_list<unsigned char>(file, "/volume/fixed", contents.volume.vertices.size());
    contents.interpolation = read_interpolation(file, surface_count, contents.volume.vertices.size());
  }
  try {
    require_valid(contents);
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(file.path().string() + ": " + error.what());
  }
  return contents;
}

void require_checksum(const Hdf5File& file, const GreenStoreContents& contents) {
  if (file.has_attribute("/", kContentsChecksum) && file.read_number("/", kContentsChecksum) != checksum(contents)) {
    file.fail("/", "the mesh, material or nodes differ from their checksum; the store is damaged or was changed");
  }
}

std::uint32_t checksum(const GreenStoreContents& contents) {
  std::uint32_t crc = 0;
  const auto add = [&crc](const auto& values) {
    using Number = typename std::decay_t<decltype(values)>::value_type;
    static_assert(std::is_arithmetic_v<Number>);  // no padding
    crc = crc32c(std::as_bytes(std::span(values)), crc);
  };
  add(flat(contents.surface.positions));
  add(flat(contents.surface.parents));
  add(flat(contents.surface.base_triangles));
  add(std::vector<std::uint64_t>(contents.surface.vertex_end.begin(), contents.surface.vertex_end.end()));
  add(contents.area);
  add(contents.flags);
  add(contents.row_node);
  add(contents.column_node);
  add(flat(contents.volume.vertices));
  add(flat(contents.volume.tetrahedra));
  add(contents.volume_fixed);
  if (!contents.volume.vertices.empty()) {
    Interpolation matrix = contents.interpolation;
    matrix.makeCompressed();
    const auto rows = static_cast<std::size_t>(matrix.rows()), entries = static_cast<std::size_t>(matrix.nonZeros());
    add(std::span(matrix.outerIndexPtr(), rows + 1));
    add(std::span(matrix.innerIndexPtr(), entries));
    add(std::span(matrix.valuePtr(), entries));
  }
  add(std::vector<double>{contents.young, contents.poisson});
  if (contents.elements == Elements::quadratic) add(std::string(kQuadratic));
  for (const std::string* text : {&contents.unit, &contents.provenance, &contents.fingerprint}) add(*text);
  return crc;
}

}  // namespace greenloop
