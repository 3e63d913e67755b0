#pragma once

#include <Eigen/Core>
#include <vector>

#include "formats/mesh/triangle_mesh.hpp"
#include "offline/remesh/triangle_tree.hpp"
#include "offline/wrap/crossings.hpp"
#include "offline/wrap/wrap.hpp"

namespace greenloop::offline {

/// How far places are from a surface, a hundred thousand of them at most, evenly chosen.
[[nodiscard]] Deviation deviation(const std::vector<Eigen::Vector3d>& places, const TriangleTree& surface,
                                  double offset = 0);

/// Places on the faces that look outside and have the inside behind them: crossings, and corners.
[[nodiscard]] std::vector<Eigen::Vector3d> places_on_skin(const TriangleMesh& mesh,
                                                          const std::vector<Crossing>& crossings,
                                                          const std::vector<float>& field, const Lattice& lattice);

/// Corners, centres and middles of edges of the faces all of whose corners count.
[[nodiscard]] std::vector<Eigen::Vector3d> places_on(const TriangleMesh& mesh, const std::vector<bool>& counts);

}  // namespace greenloop::offline
