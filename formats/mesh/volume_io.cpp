#include "formats/mesh/volume_io.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "formats/mesh/volume_formats.hpp"

namespace greenloop {
namespace {

/// |det| up to this part of the longest edge cubed is flat.
constexpr double flatness = 1e-12;

/// -1, 0 (flat) or +1.
int orientation(const TetrahedralMesh& mesh, const std::array<int, 4>& tetrahedron) {
  const auto& [i, j, k, l] = tetrahedron;
  const auto &a = mesh.vertices[i], &b = mesh.vertices[j], &c = mesh.vertices[k], &d = mesh.vertices[l];
  const double det = (b - a).dot((c - a).cross(d - a));
  const double longest =
      std::max({(b - a).norm(), (c - a).norm(), (d - a).norm(), (c - b).norm(), (d - b).norm(), (d - c).norm()});
  if (!(std::abs(det) > flatness * longest * longest * longest)) {
    return 0;
  }
  return det > 0 ? 1 : -1;
}

/// The faces that one tetrahedron has.
std::vector<std::array<int, 3>> outer_faces(const std::vector<std::array<int, 4>>& tetrahedra) {
  struct Face {
    std::array<int, 3> sorted, corners;
    bool operator<(const Face& other) const { return sorted < other.sorted; }
  };
  std::vector<Face> faces;
  for (const auto& [a, b, c, d] : tetrahedra) {
    for (const auto& corners : {std::array{a, c, b}, std::array{a, b, d}, std::array{b, c, d}, std::array{c, a, d}}) {
      faces.push_back({corners, corners});
      std::sort(faces.back().sorted.begin(), faces.back().sorted.end());
    }
  }
  std::stable_sort(faces.begin(), faces.end());
  std::vector<std::array<int, 3>> outer;
  for (auto face = faces.begin(); face != faces.end();) {
    const auto next = std::upper_bound(face, faces.end(), *face);
    if (next - face == 1) outer.push_back(face->corners);
    face = next;
  }
  return outer;
}

}  // namespace

std::int64_t read_number(MeshText& text, std::string_view expected) {
  return text.integer(expected, std::numeric_limits<std::int64_t>::min(), std::numeric_limits<std::int64_t>::max());
}

void VolumeBuilder::reserve_nodes(std::size_t count) {
  numbers_.reserve(count);
  mesh_.vertices.reserve(count);
}

void VolumeBuilder::add_node(const MeshText& text, std::int64_t number, const Eigen::Vector3d& position) {
  if (!numbers_.add(number)) {
    text.fail("node " + std::to_string(number) + " again", "each node once");
  }
  mesh_.vertices.push_back(position);
}

void VolumeBuilder::add_nodes(const std::vector<Eigen::Vector3d>& positions) {
  reserve_nodes(node_count() + positions.size());
  for (const auto& position : positions) {
    static_cast<void>(numbers_.add(static_cast<std::int64_t>(node_count())));
    mesh_.vertices.push_back(position);
  }
}

void VolumeBuilder::read_node(MeshText& text) {
  const auto number = read_number(text, "a node number");
  add_node(text, number, text.point());
}

void VolumeBuilder::read_tetrahedron(MeshText& text) {
  std::array<int, 4> nodes{};
  for (int& node : nodes) {
    const auto number = read_number(text, "the number of a node");
    const auto index = numbers_.find(number);
    if (!index) {
      text.fail(std::to_string(number), "the number of one of the " + std::to_string(node_count()) + " nodes");
    }
    node = *index;
  }
  add_tetrahedron(nodes, text.line_number());
}

void VolumeBuilder::add_face(std::span<const std::int64_t> nodes, std::size_t line) {
  std::vector<int> corners;
  for (const auto number : nodes) {
    if (const auto index = numbers_.find(number)) corners.push_back(*index);
  }
  if (corners.size() == nodes.size()) add_face(corners, line);
}

void VolumeBuilder::add_tetrahedron(const std::array<int, 4>& nodes, std::size_t line) {
  mesh_.tetrahedra.push_back(nodes);
  lines_.push_back(line);
}

std::string VolumeBuilder::place(std::size_t tetrahedron) const {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const int node : mesh_.tetrahedra[tetrahedron]) {
    centre += mesh_.vertices[node] / 4;
  }
  std::string text = file_.string();
  if (lines_[tetrahedron] > 0) {
    text.append(":").append(std::to_string(lines_[tetrahedron]));
  }
  text.append(": found tetrahedron ").append(std::to_string(tetrahedron)).append(" (counted from 0, centre ");
  append_point(text, centre);
  return text + ")";
}

void VolumeBuilder::orient() {
  std::vector<int> signs;
  signs.reserve(mesh_.tetrahedra.size());
  for (const auto& tetrahedron : mesh_.tetrahedra) {
    signs.push_back(orientation(mesh_, tetrahedron));
  }
  const auto first = [&](int sign) {
    return static_cast<std::size_t>(std::find(signs.begin(), signs.end(), sign) - signs.begin());
  };
  const auto count = [&](int sign) { return static_cast<std::size_t>(std::count(signs.begin(), signs.end(), sign)); };
  if (count(0) > 0) {
    throw MeshFileError(
        place(first(0)) + " flat, " + std::to_string(count(0)) +
        " in all, expected tetrahedra with a volume; remesh there, or name the file in [surface]: its boundary "
        "is taken");
  }
  if (count(-1) == signs.size()) {
    for (auto& tetrahedron : mesh_.tetrahedra) {
      std::swap(tetrahedron[2], tetrahedron[3]);
    }
  } else if (count(-1) > 0) {
    throw MeshFileError(
        place(first(-1)) + " inverted, " + std::to_string(count(-1)) + " of " + std::to_string(signs.size()) +
        " in all, expected the same orientation everywhere; remesh there, or name the file in [surface]: its "
        "boundary is taken");
  }
}

void VolumeBuilder::drop_unused_nodes() {
  std::vector<int> renumbered(mesh_.vertices.size(), -1);
  for (const auto& tetrahedron : mesh_.tetrahedra) {
    for (const int node : tetrahedron) {
      renumbered[node] = 0;
    }
  }
  std::size_t kept = 0;
  for (std::size_t node = 0; node < renumbered.size(); ++node) {
    if (renumbered[node] == 0) {
      renumbered[node] = static_cast<int>(kept);
      mesh_.vertices[kept++] = mesh_.vertices[node];
    }
  }
  mesh_.vertices.resize(kept);
  for (auto& tetrahedron : mesh_.tetrahedra) {
    for (int& node : tetrahedron) {
      node = renumbered[node];
    }
  }
}

TetrahedralMesh VolumeBuilder::finish() {
  if (mesh_.tetrahedra.empty()) {
    throw MeshFileError(file_.string() + ": found no tetrahedron, expected a volume mesh" +
                        (faces_.size() > 0 ? "; its " + std::to_string(faces_.size()) +
                                                 " faces may be a surface: name the file in [surface]"
                                           : ""));
  }
  orient();
  drop_unused_nodes();
  return std::move(mesh_);
}

TriangleMesh VolumeBuilder::skin(MeshNotes& notes) {
  if (mesh_.tetrahedra.empty()) {
    faces_.vertices = std::move(mesh_.vertices);
    return triangulate(file_, std::move(faces_), notes);
  }
  notes.push_back("the boundary of " + std::to_string(mesh_.tetrahedra.size()) + " tetrahedra taken");
  return {std::move(mesh_.vertices), outer_faces(mesh_.tetrahedra)};
}

std::optional<VolumeBuilder> read_cells(const std::filesystem::path& file, MeshNotes& notes) {
  const auto extension = lower_extension(file);
  auto* const parse = extension == ".msh"                             ? parse_gmsh
                      : extension == ".mesh" || extension == ".meshb" ? parse_medit
                      : extension == ".vtk"                           ? parse_vtk
                      : extension == ".vtu"                           ? parse_vtu
                      : extension == ".veg"                           ? parse_vega
                      : extension == ".node" || extension == ".ele"   ? parse_tetgen
                                                                      : nullptr;
  if (parse == nullptr) return std::nullopt;
  return parse(file, read_file(file), notes);
}

TetrahedralMesh read_volume(const std::filesystem::path& file, MeshNotes& notes) {
  auto cells = read_cells(file, notes);
  if (!cells) {
    refuse_extension(file, "a file of tetrahedra: .msh, .mesh, .meshb, .vtk, .vtu, .node, .ele or .veg");
  }
  return cells->finish();
}

TetrahedralMesh read_volume(const std::filesystem::path& file) {
  MeshNotes unheard;
  return read_volume(file, unheard);
}

std::vector<std::filesystem::path> files_of_mesh(const std::filesystem::path& file) {
  const auto extension = lower_extension(file);
  if (extension == ".node" || extension == ".ele") {
    return {file, tetgen_sibling(file)};
  }
  return {file};
}

void write_volume(const std::filesystem::path& file, const TetrahedralMesh& mesh) {
  const auto extension = lower_extension(file);
  auto* const format = extension == ".msh"    ? format_gmsh
                       : extension == ".mesh" ? format_medit
                       : extension == ".vtk"  ? format_vtk
                                              : nullptr;
  if (format == nullptr) {
    refuse_extension(file, "a file of tetrahedra: .msh, .mesh or .vtk");
  }
  write_file(file, format(mesh));
}

}  // namespace greenloop
