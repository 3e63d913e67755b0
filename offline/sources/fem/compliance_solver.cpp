#include "offline/sources/fem/compliance_solver.hpp"

#include <vector>

#include "offline/volume/boundary_interpolation.hpp"

namespace greenloop::offline {

Eigen::SparseMatrix<double> unit_patterns(const GreenStoreContents& contents, std::span<const int> nodes) {
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t c = 0; c < nodes.size(); ++c) entries.emplace_back(nodes[c], static_cast<int>(c), 1.0);
  Eigen::SparseMatrix<double> patterns(contents.interpolation.rows(), static_cast<Eigen::Index>(nodes.size()));
  patterns.setFromTriplets(entries.begin(), entries.end());
  return patterns;
}

ComplianceSolver::ComplianceSolver(const GreenStoreContents& contents)
    : contents_(contents),
      free_(contents.volume_fixed),
      factors_(assemble_stiffness(contents.volume, {contents.young, contents.poisson}, free_), 3) {}

Eigen::MatrixXd ComplianceSolver::displacement(const Eigen::SparseMatrix<double>& patterns) {
  factors_.solve(volume_forces(patterns), volume_displacement_);
  Eigen::MatrixXd displacement(3 * static_cast<Eigen::Index>(contents_.row_node.size()), 3 * patterns.cols());
  for (Eigen::Index c = 0; c < displacement.cols(); ++c) gather(c, displacement);
  return displacement;
}

Eigen::SparseMatrix<double> ComplianceSolver::volume_forces(const Eigen::SparseMatrix<double>& patterns) const {
  std::vector<Eigen::Triplet<double>> entries;
  for (int c = 0; c < patterns.outerSize(); ++c) {
    for (Eigen::SparseMatrix<double>::InnerIterator node(patterns, c); node; ++node) {
      for (Interpolation::InnerIterator it(contents_.interpolation, node.row()); it; ++it) {
        const int number = free_.number[it.col()];
        if (number < 0) continue;
        for (int axis = 0; axis < 3; ++axis) {
          entries.emplace_back(3 * number + axis, 3 * c + axis, node.value() * it.value());
        }
      }
    }
  }
  Eigen::SparseMatrix<double> forces(Eigen::Index{3} * free_.count, 3 * patterns.cols());
  forces.setFromTriplets(entries.begin(), entries.end());
  return forces;
}

void ComplianceSolver::gather(Eigen::Index column, Eigen::MatrixXd& displacement) const {
  for (std::size_t r = 0; r < contents_.row_node.size(); ++r) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (Interpolation::InnerIterator it(contents_.interpolation, contents_.row_node[r]); it; ++it) {
      const Eigen::Index number = free_.number[it.col()];
      if (number >= 0) sum += it.value() * volume_displacement_.col(column).segment<3>(3 * number);
    }
    displacement.col(column).segment<3>(3 * static_cast<Eigen::Index>(r)) = sum;
  }
}

}  // namespace greenloop::offline
