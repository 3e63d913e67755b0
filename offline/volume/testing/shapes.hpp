#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

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

/// Planes across x, y and z between which cells stand, increasing.
using Planes = std::array<std::vector<double>, 3>;

/// The same between planes of one's own.
[[nodiscard]] TetrahedralMesh box(const Planes& planes);

/// The cells of a gel pad 20 x 20 x 3 mm around the z axis, its lower side at 0: `middle`, an even number, of even ones
/// within 4 mm of the axis along x and y, `rim` more on either side of these, and `layers` along z, each larger than
/// the one before by the same factor towards the rim and the lower side.
[[nodiscard]] Planes gel_pad(int middle, int rim, int layers);

/// The same pad for an edge along y, 5 mm long and of 1 mm radius, with cells finer where it lets go: `fine` times 20
/// cells on either side of the axis along x and along y, and 4 along z. Over `fine`, they are 1/6 mm beside the edge
/// and at its ends, 1/2 mm along its middle and 1/3 mm elsewhere within 4 mm of the axis.
[[nodiscard]] Planes edge_pad(int fine);

/// The ball shell between `inner` and `outer` radius: `layers` layers of a sphere split `levels` times, each prism cut
/// into three tetrahedra; layer radii grow geometrically. The inner sphere's vertices come first.
[[nodiscard]] TetrahedralMesh shell(int levels, int layers, double inner, double outer);

}  // namespace greenloop::offline::testing
