#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "formats/mesh/tetrahedral_mesh.hpp"

namespace greenloop::offline {

/// A point as a sum of a tetrahedron's corners; negative coordinates where it lies outside.
struct Barycentric {
  std::uint32_t tetrahedron;
  Eigen::Vector4d coordinate;

  [[nodiscard]] double least() const { return coordinate.minCoeff(); }
};

/// Cells of space that list the tetrahedra whose boxes reach into them. Refers to the mesh.
class TetrahedronGrid {
 public:
  /// Work: tetrahedra. Throws std::invalid_argument on a mesh without tetrahedra or with one without volume.
  explicit TetrahedronGrid(const TetrahedralMesh& mesh);

  using Allowed = std::function<bool(std::uint32_t tetrahedron)>;

  /// Of the allowed tetrahedra near the point the one that needs least to be continued: whose least coordinate is
  /// greatest, the first of equals. None if there is none in the cells within `rings` of the point's.
  /// Work: the tetrahedra of a few cells; of all within the rings where none is allowed.
  [[nodiscard]] std::optional<Barycentric> nearest(const Eigen::Vector3d& point, int rings,
                                                   const Allowed& allowed) const;
  /// The same of all tetrahedra.
  [[nodiscard]] Barycentric nearest(const Eigen::Vector3d& point) const;

  /// A number that points of the same two by two by two cells have in common.
  [[nodiscard]] std::size_t region(const Eigen::Vector3d& point) const;

 private:
  [[nodiscard]] Eigen::Vector3i cell_of(const Eigen::Vector3d& point) const;
  [[nodiscard]] std::size_t index_of(const Eigen::Vector3i& cell) const;
  [[nodiscard]] Eigen::Vector4d coordinates(std::uint32_t tetrahedron, const Eigen::Vector3d& point) const;

  const TetrahedralMesh& mesh_;
  std::vector<Eigen::Matrix3d> inverse_;  // of each tetrahedron's edges
  Eigen::Vector3d origin_;
  Eigen::Vector3i cells_;
  double size_;
  std::vector<std::uint32_t> start_, entry_;
};

}  // namespace greenloop::offline
