#include "offline/sources/fem/elasticity.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <stdexcept>
#include <string>

namespace greenloop::offline {
namespace {

Eigen::Matrix<double, 3, 4> corners_of(const TetrahedralMesh& mesh, const std::array<int, 4>& tetrahedron) {
  Eigen::Matrix<double, 3, 4> corners;
  for (int a = 0; a < 4; ++a) corners.col(a) = mesh.vertices[tetrahedron[a]];
  return corners;
}

/// Scatters the element's blocks between free vertices into the lower triangle.
void scatter(const Eigen::Matrix<double, 12, 12>& element, const std::array<int, 4>& tetrahedron,
             const FreeVertices& free, std::vector<Eigen::Triplet<double>>& entries) {
  for (int a = 0; a < 4; ++a) {
    const int row = free.number[tetrahedron[a]];
    for (int b = 0; b < 4; ++b) {
      const int column = free.number[tetrahedron[b]];
      if (row < 0 || column < 0 || row < column) continue;
      for (int i = 0; i < 3; ++i) {
        const int last = row == column ? i : 2;
        for (int j = 0; j <= last; ++j) {
          entries.emplace_back(3 * row + i, 3 * column + j, element(3 * a + i, 3 * b + j));
        }
      }
    }
  }
}

}  // namespace

void require_valid(const Material& material) {
  if (!(material.young > 0.0) || !std::isfinite(material.young)) {
    throw std::invalid_argument("material: Young's modulus is " + std::to_string(material.young) +
                                " Pa, it must be positive");
  }
  if (!(material.poisson > -1.0 && material.poisson < 0.5)) {
    throw std::invalid_argument("material: Poisson's ratio is " + std::to_string(material.poisson) +
                                ", it must lie between -1 and 0.5, both excluded");
  }
}

Lame::Lame(const Material& m)
    : lambda(m.young * m.poisson / ((1.0 + m.poisson) * (1.0 - 2.0 * m.poisson))),
      mu(m.young / (2.0 * (1.0 + m.poisson))) {
  require_valid(m);
}

Eigen::Matrix<double, 12, 12> element_stiffness(const Eigen::Matrix<double, 3, 4>& corners, const Material& material) {
  const Lame lame(material);
  Eigen::Matrix3d edges;
  for (int a = 0; a < 3; ++a) edges.row(a) = (corners.col(a + 1) - corners.col(0)).transpose();
  const double volume = edges.determinant() / 6.0;
  Eigen::Matrix<double, 3, 4> gradient;
  gradient.rightCols<3>() = edges.inverse();
  gradient.col(0) = -gradient.rightCols<3>().rowwise().sum();

  Eigen::Matrix<double, 12, 12> stiffness;
  for (Eigen::Index a = 0; a < 4; ++a) {
    for (Eigen::Index b = 0; b < 4; ++b) {
      const Eigen::Vector3d ga = gradient.col(a), gb = gradient.col(b);
      stiffness.block<3, 3>(3 * a, 3 * b) =
          volume * (lame.lambda * ga * gb.transpose() + lame.mu * gb * ga.transpose() +
                    lame.mu * ga.dot(gb) * Eigen::Matrix3d::Identity());
    }
  }
  return stiffness;
}

Eigen::SparseMatrix<double> assemble_stiffness(const TetrahedralMesh& mesh, const Material& material,
                                               const FreeVertices& free) {
  require_valid(material);
  if (free.number.size() != mesh.vertices.size()) {
    throw std::invalid_argument("stiffness: " + std::to_string(free.number.size()) + " vertices marked of " +
                                std::to_string(mesh.vertices.size()));
  }
  constexpr std::size_t kLowerEntries = 78;
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(kLowerEntries * mesh.tetrahedra.size());
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    const auto corners = corners_of(mesh, mesh.tetrahedra[t]);
    const Eigen::Vector3d a = corners.col(1) - corners.col(0), b = corners.col(2) - corners.col(0);
    if (!(a.cross(b).dot(corners.col(3) - corners.col(0)) > 0.0)) {
      throw std::invalid_argument("stiffness: tetrahedron " + std::to_string(t) +
                                  " has no positive volume; repair the tetrahedral mesh");
    }
    scatter(element_stiffness(corners, material), mesh.tetrahedra[t], free, entries);
  }
  const Eigen::Index unknowns = Eigen::Index{3} * free.count;
  Eigen::SparseMatrix<double> stiffness(unknowns, unknowns);
  stiffness.setFromTriplets(entries.begin(), entries.end());
  return stiffness;
}

}  // namespace greenloop::offline
