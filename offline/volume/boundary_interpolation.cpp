#include "offline/volume/boundary_interpolation.hpp"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "offline/remesh/surface.hpp"
#include "offline/remesh/triangle_tree.hpp"
#include "offline/surface/shells.hpp"
#include "offline/volume/tetrahedra_quality.hpp"

namespace greenloop::offline {
namespace {

/// Rows of `nodes` and columns of free vertices.
Eigen::SparseMatrix<double> weights_on_free_vertices(const Interpolation& interpolation, const std::vector<int>& nodes,
                                                     const std::vector<std::uint8_t>& volume_fixed) {
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const auto before = entries.size();
    for (Interpolation::InnerIterator it(interpolation, nodes[k]); it; ++it) {
      if (volume_fixed[it.col()] == 0 && it.value() != 0.0) {
        entries.emplace_back(static_cast<int>(k), static_cast<int>(it.col()), it.value());
      }
    }
    if (entries.size() == before) {
      throw std::runtime_error("surface node " + std::to_string(nodes[k]) +
                               " cannot move: all volume vertices around it are fixed; do not make it touchable");
    }
  }
  Eigen::SparseMatrix<double> weights(static_cast<Eigen::Index>(nodes.size()), interpolation.cols());
  weights.setFromTriplets(entries.begin(), entries.end());
  return weights;
}

int nonempty_columns(const Eigen::SparseMatrix<double>& matrix) {
  int count = 0;
  for (int c = 0; c < matrix.outerSize(); ++c) count += Eigen::SparseMatrix<double>::InnerIterator(matrix, c) ? 1 : 0;
  return count;
}

/// Each level less leaves a fourth of the nodes: how many less leave no more of them than vertices, one at least.
std::string remedy(std::size_t nodes, int vertices) {
  int fewer = 1;
  while (vertices > 0 && std::ldexp(static_cast<double>(nodes), -2 * fewer) > vertices) ++fewer;
  return "; use fewer levels (remesh.levels; " + std::to_string(fewer) + " less would do) or a finer tetrahedral mesh";
}

}  // namespace

Interpolation select_first_vertices(int surface_nodes, int volume_vertices) {
  Interpolation selection(surface_nodes, volume_vertices);
  selection.reserve(Eigen::VectorXi::Ones(surface_nodes));
  for (int v = 0; v < surface_nodes; ++v) selection.insert(v, v) = 1.0;
  selection.makeCompressed();
  return selection;
}

Boundary extract_boundary(const TetrahedralMesh& volume) {
  Boundary boundary;
  boundary.surface.triangles = boundary_triangles(volume);
  std::vector<int> number(volume.vertices.size(), -1);
  for (const auto& triangle : boundary.surface.triangles) {
    for (const int v : triangle) number[v] = 0;
  }
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (number[v] < 0) continue;
    number[v] = static_cast<int>(boundary.volume_vertex.size());
    boundary.volume_vertex.push_back(static_cast<int>(v));
    boundary.surface.vertices.push_back(volume.vertices[v]);
  }
  for (auto& triangle : boundary.surface.triangles) {
    for (int& v : triangle) v = number[v];
  }
  return boundary;
}

TriangleMesh cavity_walls(const TetrahedralMesh& volume) {
  return inward_pieces({volume.vertices, boundary_triangles(volume)});
}

Interpolation interpolate_on_boundary(const std::vector<Eigen::Vector3d>& nodes, const TetrahedralMesh& volume,
                                      double tolerance) {
  const auto boundary = extract_boundary(volume);
  const TriangleTree tree(boundary.surface);
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    const auto place = tree.closest(nodes[n]);
    const auto& triangle = boundary.surface.triangles[place.triangle];
    Eigen::Vector3d found = Eigen::Vector3d::Zero();
    for (int k = 0; k < 3; ++k) {
      found += place.weights[k] * boundary.surface.vertices[triangle[k]];
      if (place.weights[k] == 0.0) continue;
      entries.emplace_back(static_cast<int>(n), boundary.volume_vertex[triangle[k]], place.weights[k]);
    }
    const double distance = (found - nodes[n]).norm();
    if (!(distance <= tolerance)) {
      throw std::runtime_error("surface node " + std::to_string(n) + " lies " + std::to_string(distance) +
                               " m off the tetrahedral mesh, " + std::to_string(tolerance) +
                               " m are allowed; do the two have the same unit and place?");
    }
  }
  Interpolation interpolation(static_cast<Eigen::Index>(nodes.size()),
                              static_cast<Eigen::Index>(volume.vertices.size()));
  interpolation.setFromTriplets(entries.begin(), entries.end());
  return interpolation;
}

void require_independent(const Interpolation& interpolation, const std::vector<int>& nodes,
                         const std::vector<std::uint8_t>& volume_fixed) {
  const auto weights = weights_on_free_vertices(interpolation, nodes, volume_fixed);
  const int vertices = nonempty_columns(weights);
  if (static_cast<int>(nodes.size()) > vertices) {
    throw std::runtime_error(std::to_string(nodes.size()) + " touchable surface nodes hang on only " +
                             std::to_string(vertices) + " free boundary vertices of the tetrahedral mesh" +
                             remedy(nodes.size(), vertices));
  }
  const Eigen::SparseMatrix<double> gram = weights * weights.transpose();
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factors(gram);
  constexpr double kSmallestPivot = 1e-10;
  for (Eigen::Index k = 0; k < factors.vectorD().size(); ++k) {
    if (factors.info() == Eigen::Success && factors.vectorD()[k] > kSmallestPivot) continue;
    const int node = nodes[factors.permutationPinv().indices()[k]];
    throw std::runtime_error("surface node " + std::to_string(node) +
                             " moves exactly as its neighbours make it: too many surface nodes on one boundary "
                             "triangle of the tetrahedral mesh" +
                             remedy(nodes.size(), vertices));
  }
}

}  // namespace greenloop::offline
