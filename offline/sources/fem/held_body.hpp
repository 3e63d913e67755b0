#pragma once

#include <Eigen/Cholesky>
#include <optional>
#include <span>
#include <vector>

#include "offline/sources/fem/elasticity.hpp"
#include "offline/sources/fem/factorization.hpp"
#include "offline/sources/fem/quadratic_elements.hpp"

namespace greenloop::offline {

/// A body with some vertices and edges held, the others free. Refers to the mesh and the edges.
class HeldBody {
 public:
  /// Factorises the linear elements. Throws std::runtime_error when what is held does not support the body.
  HeldBody(const TetrahedralMesh& mesh, const MeshEdges& edges, const Material& material, Held held);

  [[nodiscard]] const TetrahedralMesh& mesh() const { return mesh_; }
  [[nodiscard]] const MeshEdges& edges() const { return edges_; }
  [[nodiscard]] const Material& material() const { return material_; }
  [[nodiscard]] const Held& held() const { return held_; }

  /// Moves the free vertices into balance, with linear elements: all edges of `displacement` must be zero. Gives the
  /// energy (twice: the work of the forces that hold).
  double balance_linear(QuadraticField& displacement);

  /// How far conjugate gradients came.
  struct Descent {
    double released = 0;  ///< by which twice the energy fell
    bool settled = true;  ///< the last ten iterations released less than 2 % of it
  };

  /// Moves all that is free towards balance, from where it is, by conjugate gradients, preconditioned by the factor of
  /// the linear elements and a 3 x 3 block for each edge. Work: 400 element sweeps and solves at most.
  Descent descend(QuadraticField& displacement);

 private:
  [[nodiscard]] Eigen::Matrix3Xd relax_vertices(const Eigen::Matrix3Xd& force);
  [[nodiscard]] Eigen::Matrix3Xd relax_edges(const Eigen::Matrix3Xd& force) const;

  const TetrahedralMesh& mesh_;
  const MeshEdges& edges_;
  Material material_;
  Held held_;
  FreeVertices free_;
  QuadraticStiffness stiffness_;
  std::optional<Factorization> factors_;  // none if no vertex is free
  std::vector<Eigen::LLT<Eigen::Matrix3d>> edge_block_;
};

/// Twice the energy of a displacement that is held, with ever richer elements. For a unit displacement of a patch it is
/// the force on it.
struct HeldForces {
  double linear = 0, quadratic = 0;
  double extrapolated = 0;  ///< beyond quadratic elements on tetrahedra that are split once
  bool settled = true;
};

/// Up to 2,000 tetrahedra, those whose centers are nearest to the vertices.
[[nodiscard]] std::vector<int> tetrahedra_around(const TetrahedralMesh& mesh, std::span<const int> vertices);

/// `displacement`: of what is held, zero elsewhere. `refined`: the tetrahedra that are split, around what is held.
/// Where the stress is singular, as at the edge of a patch, the energy falls towards its limit with the size of the
/// elements, so what half the size releases is released once more.
[[nodiscard]] HeldForces held_forces(HeldBody& body, QuadraticField displacement, std::span<const int> refined);

}  // namespace greenloop::offline
