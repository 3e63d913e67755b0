#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "formats/mesh/triangle_mesh.hpp"

namespace greenloop::offline {

/// neighbors[f][e] is the triangle across the edge from corner e to corner e + 1 of triangle f.
/// Throws std::invalid_argument where an edge does not have exactly two triangles of opposite direction.
[[nodiscard]] std::vector<std::array<int, 3>> triangle_neighbors(const std::vector<std::array<int, 3>>& triangles);

/// A place on a triangle surface: barycentric weights (>= 0, sum 1) of the corners of one triangle.
struct SurfacePoint {
  int triangle = 0;
  Eigen::Vector3d weights = Eigen::Vector3d::Zero();
};

/// A closed surface to place points on and to walk along. Keeps a copy of the mesh.
class Surface {
 public:
  /// `sharp` edges (pairs of neighbouring vertices) end walks, and their vertices have no say in normals.
  /// Throws std::invalid_argument if the mesh is not closed and manifold.
  explicit Surface(TriangleMesh mesh, const std::vector<std::array<int, 2>>& sharp = {});

  [[nodiscard]] const TriangleMesh& mesh() const { return mesh_; }
  [[nodiscard]] Eigen::Vector3d position(const SurfacePoint& point) const;
  /// Unit normal interpolated from the angle-weighted normals of the corners.
  [[nodiscard]] Eigen::Vector3d normal(const SurfacePoint& point) const;
  /// Unit normal of a triangle.
  [[nodiscard]] const Eigen::Vector3d& triangle_normal(int triangle) const { return triangle_normals_[triangle]; }
  /// Follows the straightest path (unfolding one triangle after the other) from `start` in the direction of
  /// `displacement` laid into the start triangle's plane, for the length of `displacement`. Never leaves the surface,
  /// so it cannot jump to the other side of a thin part, and stops at a sharp edge. Work: linear in the edges crossed,
  /// 1,000 at most.
  [[nodiscard]] SurfacePoint walk(const SurfacePoint& start, const Eigen::Vector3d& displacement) const;

 private:
  void set_sharp(const std::vector<std::array<int, 2>>& edges);

  TriangleMesh mesh_;
  std::vector<std::array<int, 3>> neighbors_;
  std::vector<std::array<char, 3>> sharp_;  ///< of the edges of each triangle
  std::vector<Eigen::Vector3d> vertex_normals_;
  std::vector<Eigen::Vector3d> triangle_normals_;
};

}  // namespace greenloop::offline
