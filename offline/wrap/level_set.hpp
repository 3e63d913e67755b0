#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "formats/mesh/triangle_mesh.hpp"
#include "offline/wrap/lattice.hpp"

namespace greenloop::offline {

/// Distances are kept this far from a surface, in spacings.
inline constexpr float band = 3;

/// The distance of every lattice point to the triangles, at most `band`. The triangles lie inside the lattice and none
/// has zero area. Work: linear in points and in the area of the triangles.
[[nodiscard]] std::vector<float> unsigned_distance(const TriangleMesh& mesh, const Lattice& lattice);

/// A surface of four-sided faces.
struct QuadSurface {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::array<int, 4>> quads;
};

/// Where a field, negative inside, is zero: one vertex in each of the lattice's cells that it passes through, outward
/// oriented. The same field gives the same bits on any number of processors.
[[nodiscard]] QuadSurface zero_surface(const std::vector<float>& field, const Lattice& lattice);

}  // namespace greenloop::offline
