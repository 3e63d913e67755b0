#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "formats/mesh/mesh_text.hpp"
#include "formats/mesh/number_array.hpp"
#include "formats/mesh/vtk_cells.hpp"

namespace greenloop {

/// A legacy VTK file, ascii or binary (big endian), versions to 5.1: its header is read, the parts are read as their
/// keywords come. Throws MeshFileError like MeshText.
class VtkLegacy {
 public:
  VtkLegacy(const std::filesystem::path& file, std::string content, std::string_view dataset);

  [[nodiscard]] MeshText& text() { return text_; }
  /// Behind the keyword POINTS.
  [[nodiscard]] std::vector<Eigen::Vector3d> read_points();
  /// Behind a keyword such as CELLS or POLYGONS; indices are below point_count.
  [[nodiscard]] VtkCells read_cells(std::size_t point_count);
  /// Numbers that begin on the next line.
  [[nodiscard]] NumberArray numbers(Scalar type, std::size_t count);
  /// Passes over what FIELD or METADATA announces; false if the keyword is another one.
  [[nodiscard]] bool skip_part(std::string_view keyword);

 private:
  [[nodiscard]] Scalar read_type();
  void read_counted_cells(std::size_t count, std::size_t size, std::size_t point_count, VtkCells& cells);
  void read_offset_cells(std::size_t offset_count, std::size_t size, std::size_t point_count, VtkCells& cells);
  void skip_field();

  std::filesystem::path file_;
  MeshText text_;
  bool binary_ = false;
};

}  // namespace greenloop
