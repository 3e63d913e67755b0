#pragma once

#include <Eigen/Core>

#include "formats/mesh/semi_regular_mesh.hpp"
#include "formats/mesh/tetrahedral_mesh.hpp"
#include "formats/mesh/triangle_mesh.hpp"

namespace greenloop::offline::testing {

/// An icosahedron split `levels` times, its vertices on the ellipsoid of these semi-axes: 10 * 4^levels + 2 vertices.
[[nodiscard]] SemiRegularMesh ellipsoid(int levels, const Eigen::Vector3d& semi_axes);

/// A torus about the z axis.
[[nodiscard]] TriangleMesh torus(double radius, double tube_radius, int around, int across);

/// A box from the origin to `size`, each of its cells split into six tetrahedra.
[[nodiscard]] TetrahedralMesh box(const Eigen::Vector3i& cells, const Eigen::Vector3d& size);

/// The ball shell between `inner` and `outer` radius: `layers` layers of a sphere split `levels` times, each prism cut
/// into three tetrahedra; layer radii grow geometrically. The inner sphere's vertices come first.
[[nodiscard]] TetrahedralMesh shell(int levels, int layers, double inner, double outer);

}  // namespace greenloop::offline::testing
