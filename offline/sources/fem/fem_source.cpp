#include "offline/sources/fem/fem_source.hpp"

#include <algorithm>
#include <vector>

#include "offline/sources/fem/quadratic_elements.hpp"

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

Eigen::SparseMatrix<double> assemble_stiffness(const FemProblem& problem, const FreeVertices& free) {
  if (problem.elements == Elements::linear) return assemble_stiffness(problem.volume, problem.material, free);
  const MeshEdges edges = list_edges(problem.volume);
  return assemble_stiffness(problem.volume, edges, problem.material, free, inner_edges(problem.volume, edges));
}

Eigen::SparseMatrix<double> unit_patterns(Eigen::Index surface_nodes, std::span<const int> nodes) {
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t c = 0; c < nodes.size(); ++c) entries.emplace_back(nodes[c], static_cast<int>(c), 1.0);
  Eigen::SparseMatrix<double> patterns(surface_nodes, static_cast<Eigen::Index>(nodes.size()));
  patterns.setFromTriplets(entries.begin(), entries.end());
  return patterns;
}

std::int64_t unknowns(const FemProblem& problem) {
  std::int64_t points = FreeVertices(problem.fixed).count;
  if (problem.elements == Elements::quadratic) {
    const auto inner = inner_edges(problem.volume, list_edges(problem.volume));
    points += std::count(inner.begin(), inner.end(), 1);
  }
  return 3 * points;
}

FemSource::FemSource(const FemProblem& problem)
    : problem_(problem),
      rows_{.surface_nodes = problem.row_nodes},
      free_(problem.fixed),
      unknowns_(greenloop::offline::unknowns(problem)),
      factors_(assemble_stiffness(problem, free_), 3) {}

Eigen::MatrixXd FemSource::displacement(const Eigen::SparseMatrix<double>& patterns) {
  factors_.solve(volume_forces(patterns), volume_displacement_);
  Eigen::MatrixXd displacement(3 * static_cast<Eigen::Index>(rows_.size()), 3 * patterns.cols());
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
      for (Interpolation::InnerIterator it(problem_.interpolation, node.row()); it; ++it) {
        const int number = free_.number[it.col()];
        if (number < 0) continue;
        for (int axis = 0; axis < 3; ++axis) {
          entries.emplace_back(3 * number + axis, 3 * c + axis, node.value() * it.value());
        }
      }
    }
  }
  Eigen::SparseMatrix<double> forces(unknowns_, 3 * patterns.cols());
  forces.setFromTriplets(entries.begin(), entries.end());
  return forces;
}

void FemSource::gather(Eigen::Index column, Eigen::MatrixXd& displacement) const {
  for (std::size_t r = 0; r < rows_.surface_nodes.size(); ++r) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (Interpolation::InnerIterator it(problem_.interpolation, rows_.surface_nodes[r]); it; ++it) {
      const Eigen::Index number = free_.number[it.col()];
      if (number >= 0) sum += it.value() * volume_displacement_.col(column).segment<3>(3 * number);
    }
    displacement.col(column).segment<3>(3 * static_cast<Eigen::Index>(r)) = sum;
  }
}

}  // namespace greenloop::offline
