#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <cstdint>
#include <span>

#include "formats/store/green_store.hpp"
#include "offline/sources/fem/elasticity.hpp"
#include "offline/sources/fem/factorization.hpp"

namespace greenloop::offline {

/// Unit forces at surface nodes, one pattern each.
[[nodiscard]] Eigen::SparseMatrix<double> unit_patterns(const GreenStoreContents& contents, std::span<const int> nodes);

/// Applies the compliance U = B K^-1 B^T (theory.md, section 1) of a body to forces, solution by solution: the matrix
/// itself is nowhere. Offline only, one thread at a time.
class ComplianceSolver {
 public:
  /// Patterns worth solving for at a time, 192 right-hand sides: see docs/solving.md.
  static constexpr int kPatternsAtOnce = 64;

  /// Factorises the stiffness of the volume in `contents` (n surface nodes, R row nodes), which must outlive it.
  /// Throws std::runtime_error when the body is not supported or memory runs out.
  explicit ComplianceSolver(const GreenStoreContents& contents);

  /// What forces of `patterns` (n x k; a column weighs the surface nodes) do: 3R x 3k, m/N. Row 3r + i is axis i at row
  /// node r, column 3c + j is pattern c along axis j. Work: 12 factor entries per pattern.
  [[nodiscard]] Eigen::MatrixXd displacement(const Eigen::SparseMatrix<double>& patterns);

  [[nodiscard]] std::int64_t factor_entries() const { return factors_.factor_entries(); }
  [[nodiscard]] std::int64_t unknowns() const { return 3LL * free_.count; }

 private:
  [[nodiscard]] Eigen::SparseMatrix<double> volume_forces(const Eigen::SparseMatrix<double>& patterns) const;
  void gather(Eigen::Index column, Eigen::MatrixXd& displacement) const;

  const GreenStoreContents& contents_;
  FreeVertices free_;
  Factorization factors_;
  Eigen::MatrixXd volume_displacement_;
};

}  // namespace greenloop::offline
