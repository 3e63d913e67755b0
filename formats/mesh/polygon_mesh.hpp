#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "formats/mesh/mesh_text.hpp"
#include "formats/mesh/triangle_mesh.hpp"

namespace greenloop {

/// A surface of polygons as its file gives it, the corners of one behind those of the other.
struct PolygonMesh {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<int> corners;
  std::vector<std::size_t> ends;   ///< where each polygon's corners end in `corners`
  std::vector<std::size_t> lines;  ///< where each polygon stands in its file; 0 in a binary one

  void add(std::span<const int> polygon, std::size_t line);

  [[nodiscard]] std::size_t size() const { return ends.size(); }
  [[nodiscard]] std::span<const int> operator[](std::size_t polygon) const {
    const std::size_t begin = polygon == 0 ? 0 : ends[polygon - 1];
    return std::span(corners).subspan(begin, ends[polygon] - begin);
  }
};

/// Most corners of a polygon that is not convex.
inline constexpr std::size_t most_corners = 4096;

/// Cuts the polygons into triangles, in the polygons' order and sense: a convex one into a fan around its first corner,
/// any other by clipping the best-shaped ear first, seen along the normal of its area (Newell). Corners that repeat
/// their neighbour are left out; a polygon of fewer than three is dropped, and noted. Throws MeshFileError, with the
/// polygon's place in the file, for one that crosses itself or is not convex and has more than most_corners corners.
/// Work: linear in the convex polygons' corners, corners times corners of any other.
[[nodiscard]] TriangleMesh triangulate(const std::filesystem::path& file, PolygonMesh mesh, MeshNotes& notes);

}  // namespace greenloop
