#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "formats/mesh/triangle_mesh.hpp"

namespace greenloop::offline {

/// A nodular body of revolution about z, 4 cm wide, that stands on its fixed base (after James & Pai 2001, figure 10a).
/// Its vertices lie on the body itself however fine the triangulation is.
struct Nodule {
  TriangleMesh surface;             ///< m; vertex 0 is the middle of the top
  std::vector<std::uint8_t> fixed;  ///< per vertex
};

struct NoduleOptions {
  int splits = 2;     ///< of an icosahedron, 0..6: 10 * 4^splits + 2 vertices
  double uneven = 0;  ///< 0..0.4, edge lengths by which vertices are moved at random along the body
  unsigned seed = 1;  ///< of that
};

[[nodiscard]] Nodule make_nodule(const NoduleOptions& options);

/// The point of the body in a direction, by its angle to z and around z, rad; m.
[[nodiscard]] Eigen::Vector3d nodule_point(double polar, double azimuth);

/// Its unit normal there, outwards.
[[nodiscard]] Eigen::Vector3d nodule_normal(double polar, double azimuth);

/// The mean length of its edges, m.
[[nodiscard]] double mean_edge(const TriangleMesh& surface);

}  // namespace greenloop::offline
