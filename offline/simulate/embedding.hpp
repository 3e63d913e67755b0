#pragma once

#include <Eigen/Core>
#include <vector>

#include "formats/mesh/tetrahedral_mesh.hpp"
#include "offline/volume/boundary_interpolation.hpp"

namespace greenloop::offline {

/// Barycentric weights of points in the tetrahedra that they lie in; of a point outside, in one nearby, whose linear
/// displacement goes on there. Work: points times tetrahedra. Throws std::invalid_argument on a mesh without
/// tetrahedra.
[[nodiscard]] Interpolation embed(const std::vector<Eigen::Vector3d>& points, const TetrahedralMesh& mesh);

}  // namespace greenloop::offline
