#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "formats/mesh/semi_regular_mesh.hpp"
#include "formats/mesh/triangle_mesh.hpp"

namespace greenloop::offline {

/// What a remeshed surface is worth, measured on its finest level.
struct RemeshQuality {
  double smallest_angle_degrees = 0;
  double hausdorff = 0;           ///< the greater of both directions, in the input's unit
  double farthest_of_mesh = 0;    ///< of the mesh from the input, in its unit
  double farthest_of_input = 0;   ///< of the input from the mesh, in its unit
  double volume_change = 0;       ///< of the enclosed volume, as a share of the input's
  double hausdorff_relative = 0;  ///< as a share of the diagonal of the input's bounding box
  std::size_t triangles = 0;
  std::size_t flipped = 0;             ///< triangles whose normal is not within 90 degrees of the input's
  std::size_t self_intersections = 0;  ///< pairs of triangles that meet where they should not
  bool kept_connectivity = false;      ///< the input already had subdivision connectivity and was kept
  int base_vertices = 0;
  int levels = 0;
  /// Where the smallest angle, the Hausdorff distance and the last flipped triangle are, as fractions of the input's
  /// bounding box.
  Eigen::Vector3d smallest_angle_at = Eigen::Vector3d::Zero();
  Eigen::Vector3d hausdorff_at = Eigen::Vector3d::Zero();
  Eigen::Vector3d flipped_at = Eigen::Vector3d::Zero();
};

/// The smallest angle of a triangle mesh, degrees.
[[nodiscard]] double smallest_angle(const TriangleMesh& mesh);

/// Measures `mesh` against `input` (kept_connectivity is left false). The Hausdorff distance is sampled from both
/// surfaces: all vertices, and on every triangle a grid of points no farther apart than 1/400 of the diagonal of the
/// input's bounding box. Throws std::invalid_argument if the input is not closed and manifold.
[[nodiscard]] RemeshQuality measure_quality(const TriangleMesh& input, const SemiRegularMesh& mesh);

}  // namespace greenloop::offline
