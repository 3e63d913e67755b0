#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "formats/layout.hpp"

namespace greenloop::offline {

/// How a coefficient's couplings are scaled: by the symmetric root of its *conditional* compliance, what is left of its
/// diagonal block once the coefficients around it are held. A force that meets stiff surroundings feels errors relative
/// to that, not to the diagonal block; on thin parts the two differ a hundredfold.
class CoefficientScale {
 public:
  /// Both 3x3, m/N. Throws std::invalid_argument naming the coefficient if `conditional` is not positive definite.
  CoefficientScale(const Eigen::Matrix3d& diagonal, const Eigen::Matrix3d& conditional, std::size_t coefficient);

  [[nodiscard]] const Eigen::Matrix3d& root() const { return root_; }
  [[nodiscard]] const Eigen::Matrix3d& inverse() const { return inverse_; }
  [[nodiscard]] const Eigen::Matrix3d& diagonal() const { return diagonal_; }  ///< scaled: identity or larger

  /// As the model file stores it: rounded, so that it takes fewer bytes to transmit, the root to round-off, the
  /// diagonal to what is little beside `quantum`, that of the couplings' values.
  [[nodiscard]] layout::Scale<3> stored(double quantum) const;

 private:
  Eigen::Matrix3d root_, inverse_, diagonal_;
};

/// A symmetric 3x3 matrix from its six numbers xx, xy, xz, yy, yz, zz.
[[nodiscard]] Eigen::Matrix3d symmetric_matrix(const float (&six)[6]);

}  // namespace greenloop::offline
