#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <cstdint>
#include <memory>

namespace greenloop::offline {

/// Sparse Cholesky factors of a symmetric positive definite matrix (sequential MUMPS, in core). Solves keep no state,
/// but only one thread may use an object at a time. Prints nothing.
class Factorization {
 public:
  /// `lower`: the lower triangle; `block`: consecutive unknowns that share their sparsity (3 for elasticity), for a
  /// cheaper analysis; it must divide the size. Throws std::runtime_error in words when the matrix is not positive
  /// definite (an unsupported body has rigid motions) or memory runs out.
  explicit Factorization(const Eigen::SparseMatrix<double>& lower, int block = 1);
  ~Factorization();
  Factorization(Factorization&&) noexcept;
  Factorization& operator=(Factorization&&) noexcept;

  /// Solutions for the columns of `right_hand_sides` (sparse, N x k), written to `solutions` (N x k, contiguous).
  /// Work: 4 factor_entries() per column; blocks of some hundred columns run several times faster than single ones.
  void solve(const Eigen::SparseMatrix<double>& right_hand_sides, Eigen::MatrixXd& solutions);

  /// Replaces dense right-hand sides (N x k) by their solutions. Same work.
  void solve(Eigen::MatrixXd& sides);

  [[nodiscard]] std::int64_t factor_entries() const;
  [[nodiscard]] double factor_operations() const;  ///< floating point operations of the factorisation

 private:
  struct Solver;
  std::unique_ptr<Solver> solver_;
};

}  // namespace greenloop::offline
