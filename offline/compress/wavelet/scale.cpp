#include "offline/compress/wavelet/scale.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <stdexcept>
#include <string>

namespace greenloop::offline {
namespace {

void store(const Eigen::Matrix3d& symmetric, float (&six)[6]) {
  int k = 0;
  for (int i = 0; i < 3; ++i) {
    for (int j = i; j < 3; ++j) six[k++] = static_cast<float>(symmetric(i, j));
  }
}

// to multiples of the next power of two below `step`, zeros without a sign
Eigen::Matrix3d rounded(const Eigen::Matrix3d& matrix, double step) {
  const double unit = std::exp2(std::floor(std::log2(step)));
  return unit * ((matrix / unit).array().round() + 0.0).matrix();
}

}  // namespace

CoefficientScale::CoefficientScale(const Eigen::Matrix3d& diagonal, const Eigen::Matrix3d& conditional,
                                   std::size_t coefficient) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(conditional);
  if (!(solver.eigenvalues().minCoeff() > 0)) {
    throw std::invalid_argument("compression: the compliance is not positive definite: wavelet coefficient " +
                                std::to_string(coefficient) + " has the conditional compliance " +
                                std::to_string(solver.eigenvalues().minCoeff()) +
                                " m/N; are the exact columns those of an elastic body?");
  }
  root_ = solver.operatorSqrt();
  inverse_ = solver.operatorInverseSqrt();
  diagonal_ = inverse_ * diagonal * inverse_;
}

layout::Scale<3> CoefficientScale::stored(double quantum) const {
  constexpr double root_share = 0x1p-18;   // of the least eigenvalue
  constexpr double diagonal_share = 0.25;  // of the quantum
  const double least = 1 / inverse_.norm();
  layout::Scale<3> scale{};
  store(rounded(root_, root_share * least), scale.root);
  store(rounded(0.5 * (diagonal_ + diagonal_.transpose()), diagonal_share * quantum), scale.diagonal);
  return scale;
}

Eigen::Matrix3d symmetric_matrix(const float (&six)[6]) {
  Eigen::Matrix3f matrix;
  matrix << six[0], six[1], six[2], six[1], six[3], six[4], six[2], six[4], six[5];
  return matrix.cast<double>();
}

}  // namespace greenloop::offline
