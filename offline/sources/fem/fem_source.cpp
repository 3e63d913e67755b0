#include "offline/sources/fem/fem_source.hpp"

#include <vector>

namespace greenloop::offline {

FemProblem fem_problem(const GreenStoreContents& contents) {
  return {.volume = contents.volume,
          .fixed = contents.volume_fixed,
          .interpolation = contents.interpolation,
          .material = {contents.young, contents.poisson},
          .row_nodes = contents.row_node,
          .column_nodes = contents.column_node,
          .elements = contents.elements};
}

Eigen::SparseMatrix<double> unit_patterns(Eigen::Index surface_nodes, std::span<const int> nodes) {
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t c = 0; c < nodes.size(); ++c) entries.emplace_back(nodes[c], static_cast<int>(c), 1.0);
  Eigen::SparseMatrix<double> patterns(surface_nodes, static_cast<Eigen::Index>(nodes.size()));
  patterns.setFromTriplets(entries.begin(), entries.end());
  return patterns;
}

std::int64_t unknowns(const FemProblem& problem) {
  return 3LL * free_points(problem, list_edges(problem.volume)).count;
}

FemSource::FemSource(const FemProblem& problem, const MeshEdges& edges)
    : FemSource(problem, edges, free_points(problem, edges)) {}

FemSource::FemSource(const FemProblem& problem, const MeshEdges& edges, const FreePoints& free)
    : problem_(problem),
      rows_{.surface_nodes = problem.row_nodes},
      interpolation_(nodes_from_points(problem, edges, free)),
      point_volumes_(point_volumes(problem, edges, free)),
      factors_(assemble_stiffness(problem, edges, free), 3) {}

Eigen::MatrixXd FemSource::displacement(const Eigen::SparseMatrix<double>& patterns) {
  return solve(volume_forces(patterns));
}

Eigen::MatrixXd FemSource::body_force() {
  std::vector<Eigen::Triplet<double>> entries;
  for (int point = 0; point < point_volumes_.size(); ++point) {
    for (int axis = 0; axis < 3; ++axis) entries.emplace_back(3 * point + axis, axis, point_volumes_[point]);
  }
  Eigen::SparseMatrix<double> forces(unknowns(), 3);
  forces.setFromTriplets(entries.begin(), entries.end());
  return solve(forces);
}

Eigen::MatrixXd FemSource::solve(const Eigen::SparseMatrix<double>& forces) {
  factors_.solve(forces, volume_displacement_);
  Eigen::MatrixXd displacement(3 * static_cast<Eigen::Index>(rows_.size()), forces.cols());
  for (Eigen::Index c = 0; c < displacement.cols(); ++c) gather(c, displacement);
  return displacement;
}

Eigen::MatrixXd FemSource::read(std::span<const int> columns) {
  std::vector<int> nodes;
  for (const int column : columns) nodes.push_back(problem_.column_nodes.at(static_cast<std::size_t>(column)));
  return displacement(unit_patterns(problem_.interpolation.rows(), nodes));
}

Eigen::SparseMatrix<double> FemSource::volume_forces(const Eigen::SparseMatrix<double>& patterns) const {
  std::vector<Eigen::Triplet<double>> entries;
  for (int c = 0; c < patterns.outerSize(); ++c) {
    for (Eigen::SparseMatrix<double>::InnerIterator node(patterns, c); node; ++node) {
      for (Interpolation::InnerIterator it(interpolation_, node.row()); it; ++it) {
        for (int axis = 0; axis < 3; ++axis) {
          entries.emplace_back(3 * it.col() + axis, 3 * c + axis, node.value() * it.value());
        }
      }
    }
  }
  Eigen::SparseMatrix<double> forces(unknowns(), 3 * patterns.cols());
  forces.setFromTriplets(entries.begin(), entries.end());
  return forces;
}

void FemSource::gather(Eigen::Index column, Eigen::MatrixXd& displacement) const {
  for (std::size_t r = 0; r < rows_.surface_nodes.size(); ++r) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (Interpolation::InnerIterator it(interpolation_, rows_.surface_nodes[r]); it; ++it) {
      sum += it.value() * volume_displacement_.col(column).segment<3>(Eigen::Index{3} * it.col());
    }
    displacement.col(column).segment<3>(3 * static_cast<Eigen::Index>(r)) = sum;
  }
}

}  // namespace greenloop::offline
