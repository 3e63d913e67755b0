#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <array>
#include <vector>

#include "formats/mesh/tetrahedral_mesh.hpp"
#include "offline/sources/fem/elasticity.hpp"

namespace greenloop::offline {

/// The rotation R of F = R S, S symmetric, with det R = 1 (Higham 1986; by singular values where F turns inside out).
[[nodiscard]] Eigen::Matrix3d rotation_of(const Eigen::Matrix3d& deformation);

/// Linear tetrahedra whose forces are computed one by one. Vectors hold three numbers for each free vertex, m or N;
/// what is fixed does not move. Refers to the mesh and the free vertices.
class SolidElements {
 public:
  /// One rotation for each tetrahedron.
  using Rotations = std::vector<Eigen::Matrix3d>;

  /// Throws std::invalid_argument on a tetrahedron without positive volume or a material out of range.
  SolidElements(const TetrahedralMesh& mesh, const Material& material, const FreeVertices& free);

  [[nodiscard]] Rotations no_rotations() const { return Rotations(elements_.size(), Eigen::Matrix3d::Identity()); }
  /// Of a displacement.
  [[nodiscard]] Rotations rotations(const Eigen::VectorXd& displacement) const;
  /// Their mean at each free vertex, weighted by volume.
  [[nodiscard]] Rotations vertex_rotations(const Rotations& rotations) const;

  /// The gradient of the energy V (mu |S - 1|^2 + lambda/2 tr(S - 1)^2) with S = sym(R^T F): with no rotations that of
  /// linear strain, with those of the displacement that of corotational strain (Müller & Gross 2004), in which a
  /// rotated body is at ease. Work: some 200 multiply-adds an element.
  [[nodiscard]] Eigen::VectorXd elastic_force(const Eigen::VectorXd& displacement, const Rotations& rotations) const;
  /// The energy itself, J.
  [[nodiscard]] double energy(const Eigen::VectorXd& displacement, const Rotations& rotations) const;
  /// The stiffness matrix with these rotations held, times a vector.
  [[nodiscard]] Eigen::VectorXd stiffness_times(const Rotations& rotations, const Eigen::VectorXd& vector) const;

 private:
  struct Element {
    std::array<int, 4> free;               // numbers of the free vertices, -1 of fixed ones
    Eigen::Matrix<double, 3, 4> gradient;  // of the barycentric coordinates, 1/m
    double volume;                         // m^3
  };

  [[nodiscard]] Eigen::Matrix3d gradient_of(const Element& element, const Eigen::VectorXd& vector) const;
  [[nodiscard]] Eigen::Matrix3d stress(const Eigen::Matrix3d& strain) const;
  void spread(const Element& element, const Eigen::Matrix3d& piola, Eigen::VectorXd& force) const;

  Lame lame_;
  int free_count_;
  std::vector<Element> elements_;
};

/// Consistent mass matrix over the free vertices, kg: lower triangle, one row a vertex (the same for each axis).
[[nodiscard]] Eigen::SparseMatrix<double> assemble_mass(const TetrahedralMesh& mesh, double density,
                                                        const FreeVertices& free);

/// Sums of its rows with the columns of the fixed vertices, kg: what a uniform acceleration of everything takes.
[[nodiscard]] Eigen::VectorXd vertex_masses(const TetrahedralMesh& mesh, double density, const FreeVertices& free);

}  // namespace greenloop::offline
