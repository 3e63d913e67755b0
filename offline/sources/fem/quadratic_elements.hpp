#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <array>
#include <cstdint>
#include <vector>

#include "formats/mesh/tetrahedral_mesh.hpp"
#include "formats/store/material.hpp"
#include "offline/sources/fem/elasticity.hpp"

namespace greenloop::offline {

/// Displacements, or forces, of tetrahedra whose displacement is quadratic, in hierarchical form: what linear elements
/// have, by vertex, and 4 L_a L_b times a vector of each edge's own (L: barycentric coordinates). Edges of zero are
/// linear elements. Also corrections of them, and the residuals of solutions.
struct QuadraticField {
  Eigen::Matrix3Xd vertex;  ///< 3 x vertices
  Eigen::Matrix3Xd edge;    ///< 3 x edges

  [[nodiscard]] double dot(const QuadraticField& other) const;
  void add(double factor, const QuadraticField& other);
};

/// What of a displacement is known: nonzero = held.
struct Held {
  std::vector<std::uint8_t> vertices, edges;
};

/// Edges of a mesh, each once.
struct MeshEdges {
  std::vector<std::array<int, 2>> ends;            ///< vertices, the lower first, sorted
  std::vector<std::array<int, 6>> of_tetrahedron;  ///< edges between its vertices 01 02 03 12 13 23

  /// The edge between two vertices, which must be one. Work O(log n).
  [[nodiscard]] int between(int a, int b) const;
};

/// Work O(n log n).
[[nodiscard]] MeshEdges list_edges(const TetrahedralMesh& mesh);

/// Numbers of the vertices and edges that are free, -1 of those that are held.
struct FreePoints {
  std::vector<int> vertex, edge;
  int count = 0;
};

/// Stiffness matrix of quadratic tetrahedra in hierarchical form over the free points, N/m: lower triangle only,
/// 3 count x 3 count, three degrees of freedom a point. Linear work, deterministic; 9 KB an element while it is made.
/// Throws std::invalid_argument on a tetrahedron without positive volume, or a material out of range.
[[nodiscard]] Eigen::SparseMatrix<double> assemble_stiffness(const TetrahedralMesh& mesh, const MeshEdges& edges,
                                                             const Material& material, const FreePoints& free);

/// Linear elasticity on quadratic tetrahedra with straight edges, element by element: the stiffness matrix is nowhere.
/// Refers to the mesh and the edges.
class QuadraticStiffness {
 public:
  /// Throws std::invalid_argument on a material out of range.
  QuadraticStiffness(const TetrahedralMesh& mesh, const MeshEdges& edges, const Material& material);

  [[nodiscard]] QuadraticField zero() const;

  /// Forces (N) that hold a displacement (m). Work: some 1,700 multiply-adds an element, always in the same order.
  [[nodiscard]] QuadraticField force(const QuadraticField& displacement) const;

  /// Of each edge the 3 x 3 block of the stiffness with itself, N/m.
  [[nodiscard]] std::vector<Eigen::Matrix3d> edge_blocks() const;

 private:
  const TetrahedralMesh& mesh_;
  const MeshEdges& edges_;
  Lame lame_;
};

}  // namespace greenloop::offline
