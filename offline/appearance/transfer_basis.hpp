#pragma once

#include <Eigen/Core>
#include <vector>

#include "formats/write/impulse_response.hpp"

namespace greenloop::offline {

/// Transfers in few modes: each is mean + modes * coordinates, and what that leaves out has the squares `left_out`.
struct TransferBasis {
  Eigen::VectorXf mean;                 ///< [48 vertices]
  Eigen::MatrixXf modes;                ///< U_a, [48 vertices][modes], orthonormal
  Eigen::MatrixXd coordinates;          ///< q_a, [modes][transfers]
  std::vector<double> singular_values;  ///< of all differences to the mean, falling

  /// What is left out without the modes from `rank` on, relative to all differences.
  [[nodiscard]] double truncation(Eigen::Index rank) const;
};

/// By the Gram matrix of the differences: singular values are right to 1e-6 of the largest. At most `rank` modes,
/// as few as leave out less than `error`. Throws std::runtime_error if all transfers are alike. Work: numbers times
/// transfers^2.
[[nodiscard]] TransferBasis transfer_basis(const std::vector<const Eigen::VectorXf*>& transfers, Eigen::Index rank,
                                           double error);

/// Modes and the coordinates of all rows, [modes][rows], as the file has them; `error` and `states` are left to the
/// caller. Measures the quantisation error, of all rows.
[[nodiscard]] AppearanceData quantised(const TransferBasis& basis, const Eigen::MatrixXd& rows);

}  // namespace greenloop::offline
