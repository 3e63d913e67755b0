#pragma once

// The formats behind read_volume and write_volume, one function each.

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "formats/mesh/mesh_text.hpp"
#include "formats/mesh/number_array.hpp"
#include "formats/mesh/polygon_mesh.hpp"
#include "formats/mesh/tetrahedral_mesh.hpp"
#include "formats/mesh/triangle_mesh.hpp"
#include "formats/mesh/vtk_cells.hpp"

namespace greenloop {

/// Collects nodes, tetrahedra and faces under the numbers their file gives them.
class VolumeBuilder {
 public:
  explicit VolumeBuilder(std::filesystem::path file) : file_(std::move(file)) {}

  void reserve_nodes(std::size_t count);
  /// Adds a node; a number that is taken already is refused at the token read last.
  void add_node(const MeshText& text, std::int64_t number, const Eigen::Vector3d& position);
  /// Adds nodes numbered from the count so far on.
  void add_nodes(const std::vector<Eigen::Vector3d>& positions);
  /// Reads a node number and the node's position.
  void read_node(MeshText& text);
  /// Reads four node numbers.
  void read_tetrahedron(MeshText& text);
  /// Index of a node in order of appearance, by its number.
  [[nodiscard]] std::optional<int> find_node(std::int64_t number) const { return numbers_.find(number); }
  /// Adds a tetrahedron of four node indices in order of appearance, which stands on a line of the file.
  void add_tetrahedron(const std::array<int, 4>& nodes, std::size_t line);

  [[nodiscard]] std::size_t node_count() const { return mesh_.vertices.size(); }

  /// Adds a face of the nodes with these numbers; one that names others is left out.
  void add_face(std::span<const std::int64_t> nodes, std::size_t line);
  /// Adds a face of node indices in order of appearance.
  void add_face(std::span<const int> nodes, std::size_t line) { faces_.add(nodes, line); }

  /// Drops nodes in no tetrahedron and checks orientations.
  [[nodiscard]] TetrahedralMesh finish();
  /// The faces that one tetrahedron has, wherever they look, or those in the file if there is no tetrahedron.
  [[nodiscard]] TriangleMesh skin(MeshNotes& notes);

 private:
  void orient();
  void drop_unused_nodes();
  [[nodiscard]] std::string place(std::size_t tetrahedron) const;

  std::filesystem::path file_;
  NodeNumbers numbers_;
  TetrahedralMesh mesh_;
  std::vector<std::size_t> lines_;  ///< of each tetrahedron
  PolygonMesh faces_;               ///< its vertices are mesh_'s
};

/// Any whole number, as node and element numbers may be.
[[nodiscard]] std::int64_t read_number(MeshText& text, std::string_view expected);

/// Adds a cell of a VTK grid if it is a linear tetrahedron or a polygon; throws for other volumes, naming the place in
/// `numbers`.
void add_vtk_cell(const NumberArray& numbers, const VtkCells& cells, std::size_t cell, std::int64_t type,
                  VolumeBuilder& builder);

/// Reads a file by its extension; nothing if that is no file of tetrahedra.
[[nodiscard]] std::optional<VolumeBuilder> read_cells(const std::filesystem::path& file, MeshNotes& notes);

[[nodiscard]] VolumeBuilder parse_gmsh(const std::filesystem::path& file, std::string content, MeshNotes& notes);
[[nodiscard]] VolumeBuilder parse_medit(const std::filesystem::path& file, std::string content, MeshNotes& notes);
[[nodiscard]] VolumeBuilder parse_binary_medit(const std::filesystem::path& file, std::string_view content);
[[nodiscard]] VolumeBuilder parse_vtk(const std::filesystem::path& file, std::string content, MeshNotes& notes);
[[nodiscard]] VolumeBuilder parse_vtu(const std::filesystem::path& file, std::string content, MeshNotes& notes);
[[nodiscard]] VolumeBuilder parse_tetgen(const std::filesystem::path& file, std::string content, MeshNotes& notes);
[[nodiscard]] VolumeBuilder parse_vega(const std::filesystem::path& file, std::string content, MeshNotes& notes);

/// The other file of a TetGen mesh: .ele beside .node and back, in the case of the letters of this one's extension.
[[nodiscard]] std::filesystem::path tetgen_sibling(const std::filesystem::path& file);

[[nodiscard]] std::string format_gmsh(const TetrahedralMesh& mesh);
[[nodiscard]] std::string format_medit(const TetrahedralMesh& mesh);
[[nodiscard]] std::string format_vtk(const TetrahedralMesh& mesh);

}  // namespace greenloop
