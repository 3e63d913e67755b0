#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "formats/store/green_store.hpp"
#include "offline/sources/column_source.hpp"
#include "offline/sources/fem/discretization.hpp"
#include "offline/sources/fem/factorization.hpp"

namespace greenloop::offline {

/// The one that a store describes, which must outlive it.
[[nodiscard]] FemProblem fem_problem(const GreenStoreContents& contents);

/// Degrees of freedom of its stiffness matrix.
[[nodiscard]] std::int64_t unknowns(const FemProblem& problem);

/// Unit forces at surface nodes, one pattern each: `surface_nodes` x nodes.size().
[[nodiscard]] Eigen::SparseMatrix<double> unit_patterns(Eigen::Index surface_nodes, std::span<const int> nodes);

/// Applies the compliance U = B K^-1 B^T (theory.md, section 1) of a body to forces, solution by solution: the matrix
/// itself is nowhere. Its columns are what unit forces do, m/N. Offline only, one thread at a time.
class FemSource final : public ColumnSource {
 public:
  /// Factorises the stiffness; what the problem refers to must outlive this. Throws std::runtime_error when the body is
  /// not supported or memory runs out.
  explicit FemSource(const FemProblem& problem) : FemSource(problem, list_edges(problem.volume)) {}

  /// What forces of `patterns` (n x k; a column weighs the surface nodes) do: 3R x 3k, m/N. Row 3r + i is axis i at row
  /// node r, column 3c + j is pattern c along axis j. Work: 12 factor entries per pattern.
  [[nodiscard]] Eigen::MatrixXd displacement(const Eigen::SparseMatrix<double>& patterns);

  /// What a uniform force of 1 N/m^3 on the whole body does, along x, y and z: 3R x 3, m. Work: 12 factor entries.
  [[nodiscard]] Eigen::MatrixXd body_force();

  [[nodiscard]] std::int64_t factor_entries() const { return factors_.factor_entries(); }
  [[nodiscard]] std::int64_t unknowns() const { return 3 * interpolation_.cols(); }

  [[nodiscard]] int components() const override { return 3; }
  [[nodiscard]] std::string_view unit() const override { return "m/N"; }
  [[nodiscard]] const RowSet& rows() const override { return rows_; }
  [[nodiscard]] std::span<const int> column_nodes() const override { return problem_.column_nodes; }
  [[nodiscard]] std::size_t columns_at_once() const override { return 64; }  ///< 192 sides: docs/solving.md

  /// Work: 12 factor entries per column.
  [[nodiscard]] Eigen::MatrixXd read(std::span<const int> columns) override;

 private:
  FemSource(const FemProblem& problem, const MeshEdges& edges);
  FemSource(const FemProblem& problem, const MeshEdges& edges, const FreePoints& free);
  [[nodiscard]] Eigen::SparseMatrix<double> volume_forces(const Eigen::SparseMatrix<double>& patterns) const;
  [[nodiscard]] Eigen::MatrixXd solve(const Eigen::SparseMatrix<double>& forces);
  void gather(Eigen::Index column, Eigen::MatrixXd& displacement) const;

  FemProblem problem_;
  RowSet rows_;
  Interpolation interpolation_;    // surface nodes from free points
  Eigen::VectorXd point_volumes_;  // m^3
  Factorization factors_;
  Eigen::MatrixXd volume_displacement_;
};

}  // namespace greenloop::offline
