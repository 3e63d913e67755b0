#pragma once

#include <Eigen/SparseCore>
#include <array>
#include <vector>

#include "formats/mesh/triangle_mesh.hpp"

namespace greenloop::offline {

/// A finer surface that goes along with a coarse one: its vertices are weighted means of the coarse ones.
struct FinerSheet {
  Eigen::SparseMatrix<double, Eigen::RowMajor> weights;  ///< [finer vertices][vertices], rows sum to 1
  std::vector<std::array<int, 3>> triangles;             ///< of the finer vertices; t of a level becomes 4t .. 4t+3
};

/// The surface split `levels` times by Loop's rules (1987; weights of Warren 1995), its borders by those of cubic
/// splines. Edges with more than two triangles count as borders. Work: linear in what comes out.
[[nodiscard]] FinerSheet loop_subdivision(const TriangleMesh& mesh, int levels);

}  // namespace greenloop::offline
