#pragma once

#include <Eigen/Core>

namespace greenloop::offline {

/// Values between scattered points: normalised radial basis functions (Nelles 2000), Gaussians of one width about the
/// centres, divided by their sum, with weights that fit the values there, regularised. The width is the one of some
/// multiples of the mean distance between neighbours that predicts each centre's values best from the others.
class RadialBasis {
 public:
  /// centres: [coordinates][centres], no two alike; values: [numbers][centres]. Work: centres^4.
  RadialBasis(Eigen::MatrixXd centres, const Eigen::MatrixXd& values);

  /// [numbers]. Work: centres times coordinates and numbers.
  [[nodiscard]] Eigen::VectorXd at(const Eigen::VectorXd& point) const;

 private:
  Eigen::MatrixXd centres_;
  double width_ = 0;
  Eigen::MatrixXd weights_;  // [numbers][centres]
};

}  // namespace greenloop::offline
